"""Range-only SLAM on real data: a mowing robot with wheel odometry measures its distances to radio beacons at unknown
places. All poses, the beacons, and the scale of the ranges are fitted together.

    range_slam.py FOLDER

FOLDER holds plaza1_odometry.csv, plaza1_ranges.csv, and the truth to compare with (CMU, Plaza 1). Units: metre, radian, second.
The C++ program examples/range_slam fits the same data as they come.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import slom

Vector = NDArray[np.float64]


def distance(robot: slom.SE2, beacon: Vector, scale: float) -> Any:
    return scale * np.linalg.norm(beacon - robot.pos)


def locate(places: Vector, ranges: Vector) -> Any:
    """Returns the point with these ranges to places (n, 2): differences of |x - p|^2 = r^2 are linear in x."""
    A = np.column_stack([2 * places, np.ones(len(places))])
    return np.linalg.lstsq(A, np.sum(places**2, axis=1) - ranges**2, rcond=None)[0][:2]


def read(name: str) -> Vector:
    return np.loadtxt(Path(sys.argv[1]) / f"plaza1_{name}.csv", delimiter=",", skiprows=1)


odometry, ranges, truth, true_beacons = (read(name) for name in ("odometry", "ranges", "groundtruth", "beacons"))

# Odometry: the motion of each step, and by composition the start value of each pose. The map begins at the first true pose.
forward, turn = odometry[:, 1], odometry[:, 2]
motions = [slom.SE2(f * np.cos(t / 2), f * np.sin(t / 2), t) for f, t in zip(forward, turn)]
starts = [slom.SE2(*truth[0, 1:4])]
for motion in motions:
    starts.append(starts[-1] * motion)
places = np.array([pose.pos for pose in starts])

# The pose at which each range was measured, and the number of its beacon.
at = np.searchsorted(odometry[:, 0], ranges[:, 0]) + 1
ranges, at = ranges[at < len(starts)], at[at < len(starts)]
names, beacon = np.unique(ranges[:, 2].astype(int), return_inverse=True)
early = np.array([np.flatnonzero(beacon == b)[:200] for b in range(len(names))])

est = slom.Estimator()
poses = est.variables(starts, "pose")
poses[0].fix()
beacons = est.variables(np.array([locate(places[at[i]], ranges[i, 3]) for i in early]), "beacon")
scale = est.variable(1.0, "scale")  # these radios measure too long
est.prior(scale, 1.0, 0.1)
sigma = np.column_stack([0.002 + 0.02 * abs(forward), np.full(len(turn), 0.002), 0.0005 + 0.02 * abs(turn)])
est.measure(lambda a, b: a.inverse() * b, poses[:-1], poses[1:], measured=motions, sigma=sigma, name="odometry")
est.measure(distance, poses[at], beacons[beacon], scale, measured=ranges[:, 3], sigma=0.5, loss=slom.Cauchy(1), name="range")
fit = est.optimize()
print("converged:", fit.converged)

print(f"{len(starts)} poses, {len(names)} beacons, {len(ranges)} ranges; scale {scale.value:.1f}")
for what, pos in (("odometry", places), ("fit", poses.value.pos)):
    error = np.linalg.norm(pos - truth[: len(pos), 1:3], axis=1)
    print(f"{what}: rms error of the places {np.sqrt(np.mean(error**2)):.1f} m")
for name, pos in zip(names, beacons.value):
    error = np.linalg.norm(true_beacons[:, 1:3] - pos, axis=1).min()
    print(f"beacon {name}: {error:.1f} m from a true one")
