"""Simulates a hand with a camera: python3 simulate.py writes base_hand.csv and target_camera.csv here."""
import math
import random


def exp(v):
    """The quaternion (w, x, y, z) of a rotation vector."""
    angle = math.sqrt(sum(x * x for x in v))
    factor = math.sin(angle / 2) / angle if angle > 1e-12 else 0.5
    return (math.cos(angle / 2), *(factor * x for x in v))


def times(a, b):
    (aw, ax, ay, az), (bw, bx, by, bz) = a, b
    return (aw * bw - ax * bx - ay * by - az * bz, aw * bx + ax * bw + ay * bz - az * by,
            aw * by + ay * bw + az * bx - ax * bz, aw * bz + az * bw + ax * by - ay * bx)


def inverse(q):
    return (q[0], -q[1], -q[2], -q[3])


def turned(q, p):
    return times(times(q, (0, *p)), inverse(q))[1:]


def product(a, b):
    return times(a[0], b[0]), tuple(x + y for x, y in zip(turned(a[0], b[1]), a[1]))


def inverse_pose(a):
    back = inverse(a[0])
    return back, tuple(-x for x in turned(back, a[1]))


def hand(t):
    turn = (0.5 * math.sin(1.1 * t) + 0.2 * math.sin(2.7 * t), 0.4 * math.sin(0.93 * t + 2), 0.6 * math.sin(0.71 * t + 1))
    return exp(turn), (0.6 + 0.3 * math.sin(0.8 * t), 0.25 * math.sin(1.3 * t + 1), 0.5 + 0.2 * math.sin(1.7 * t + 2))


def noisy(pose, sigma_m, sigma_rad):
    return product(pose, (exp([random.gauss(0, sigma_rad) for _ in range(3)]), [random.gauss(0, sigma_m) for _ in range(3)]))


def row(t, pose):
    (w, x, y, z), p = pose
    return ",".join(["%.4f" % t, *("%.5f" % v for v in p), *("%.6f" % v for v in (x, y, z, w))]) + "\n"


HEADER = "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n"
OFFSET = 0.043  # t_hand - t_camera [s]
hand_T_camera = exp((0.1, -0.2, 1.5)), (0.03, -0.05, 0.08)
base_T_target = exp((3.0, 0.1, -0.2)), (0.7, 0.1, -0.2)
random.seed(7)
with open("base_hand.csv", "w", encoding="ascii") as file:
    file.write(HEADER)
    file.writelines(row(100 + 0.02 * i, hand(0.02 * i)) for i in range(750))
with open("target_camera.csv", "w", encoding="ascii") as file:
    file.write(HEADER)
    for i in range(290):
        t = 0.05 * i + random.uniform(0, 0.004)
        camera = noisy(product(inverse_pose(base_T_target), product(hand(t + OFFSET), hand_T_camera)), 0.002, 0.004)
        if random.random() < 0.02:
            camera = noisy(camera, 0.2, 0.3)
        file.write(row(100 + t, camera))
