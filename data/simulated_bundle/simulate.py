#!/usr/bin/env python3
"""Writes scene.txt, as README.md describes it: python3 simulate.py > scene.txt"""
import math
import random

draw = random.Random(7).gauss
CAMERAS, POINTS, SIGMA_PX = 6, 100, 0.5


def rotation(axis_angle):
    """Rodrigues' formula."""
    angle = math.hypot(*axis_angle)
    x, y, z = (a / angle for a in axis_angle)
    c, s, d = math.cos(angle), math.sin(angle), 1 - math.cos(angle)
    return [[c + d * x * x, d * x * y - s * z, d * x * z + s * y],
            [d * x * y + s * z, c + d * y * y, d * y * z - s * x],
            [d * x * z - s * y, d * y * z + s * x, c + d * z * z]]


def pixel(camera, point):
    R, t = rotation(camera[0:3]), camera[3:6]
    P = [sum(R[i][k] * point[k] for k in range(3)) + t[i] for i in range(3)]
    p = [-P[0] / P[2], -P[1] / P[2]]
    r2 = p[0] ** 2 + p[1] ** 2
    return [camera[6] * (1 + camera[7] * r2 + camera[8] * r2 ** 2) * p[k] for k in range(2)]


def blurred(values, sigmas):
    return [x + draw(0, s) for x, s in zip(values, sigmas)]


# Points in a cube around the origin; cameras 6 m away on an arc in front of it, each turned about the vertical to face it.
points = [blurred([0, 0, 0], [1, 1, 1]) for _ in range(POINTS)]
cameras = [[0.1, 0.3 * (i - 2.5), 0.02 * i, 0.1 * i, 0.05, -6, 500 + 10 * i, -0.1, 0.02] for i in range(CAMERAS)]
seen = [(c, p) for p in range(POINTS) for c in range(CAMERAS) if draw(0, 1) > -0.8]

print(CAMERAS, POINTS, len(seen))
for c, p in seen:
    print(c, p, *("%.4f" % x for x in blurred(pixel(cameras[c], points[p]), [SIGMA_PX] * 2)))
start_sigmas = [0.01] * 3 + [0.05] * 3 + [10, 0.02, 0.005]
for camera in cameras:
    print(*("%.6g" % x for x in blurred(camera, start_sigmas)), sep="\n")
for point in points:
    print(*("%.6g" % x for x in blurred(point, [0.1] * 3)), sep="\n")
