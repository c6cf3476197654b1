"""Calibrates a stereo camera and an accelerometer from images of a level chessboard: the worked example of the paper
"Tutorial on Quick and Easy Model Fitting Using the SLoM Framework".

Frames: world z up, the board in the plane z = 0; cameras z forward. Units: metre, pixel, m/s^2. The data are simulated:
data/simulated_stereo_imu/README.md. The C++ program is examples/stereo_imu_calibration.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import slom

Vector = NDArray[np.float64]
DATA = Path(__file__).parents[2] / "data/simulated_stereo_imu"
GUESS = np.array([1000.0, 1000, 640, 480, 0, 0, 0, 0, 0])  # fx, fy, cx, cy, k1, k2, p1, p2, k3 as in OpenCV


@slom.manifold
class StereoCamera:
    left: np.ndarray
    right: np.ndarray
    left2right: slom.SE3


def project(c: Vector, point: Vector) -> Vector:
    """Returns the pixel (2,) at which a camera sees a point (3,) of its frame."""
    x, y = point[:2] / point[2]
    r2 = x * x + y * y
    radial = 1 + r2 * (c[4] + r2 * (c[5] + r2 * c[8]))
    u = x * radial + 2 * c[6] * x * y + c[7] * (r2 + 2 * x * x)
    v = y * radial + c[6] * (r2 + 2 * y * y) + 2 * c[7] * x * y
    return slom.array([c[0] * u + c[2], c[1] * v + c[3]])


def stereo(camera: StereoCamera, left2world: slom.SE3, corner: Vector) -> Vector:
    """Returns the pixels (2, 2) of a corner in the left and the right image."""
    in_left = left2world.inverse() * corner
    return np.stack([project(camera.left, in_left), project(camera.right, camera.left2right * in_left)])


def level(bias: Vector, left2world: slom.SE3, left2imu: slom.SO3, gravity: float, reading: Vector) -> Any:
    """Returns the error (3,) of a reading: at rest, the acceleration points up in the world."""
    return left2world.orient * (left2imu.inverse() * (reading - bias)) - np.array([0, 0, gravity])


def guess_pose(corners: Vector, pixels: Vector) -> slom.SE3:
    """Returns camera2world by the homography from the board to the image."""
    x, y = ((pixels - GUESS[2:4]) / GUESS[:2]).T
    w = np.column_stack([corners[:, :2], np.ones(len(corners))])
    zero = np.zeros_like(w)
    A = np.vstack([np.hstack([w, zero, -x[:, None] * w]), np.hstack([zero, w, -y[:, None] * w])])
    H = np.linalg.svd(A)[2][8].reshape(3, 3)
    H /= np.sign(H[2, 2]) * np.linalg.norm(H[:, 0])  # the board is in front of the camera
    U, _, Vt = np.linalg.svd(np.column_stack([H[:, 0], H[:, 1], np.cross(H[:, 0], H[:, 1])]))
    return slom.SE3(H[:, 2], slom.SO3(U @ Vt)).inverse()


def guess_rotation(rotated: Vector, vectors: Vector) -> slom.SO3:
    """Returns the rotation R with R * vectors closest to `rotated`, both (n, 3)."""
    U, _, Vt = np.linalg.svd(rotated.T @ vectors)
    return slom.SO3(U @ np.diag([1, 1, np.linalg.det(U @ Vt)]) @ Vt)


# Corners that both cameras see, and the valid readings.
left, right = (np.loadtxt(DATA / f"{side}_corners.csv", delimiter=",", skiprows=1) for side in ("left", "right"))
seen_right = {(row[0], row[1]): row[5:7] for row in right}
left = np.array([row for row in left if (row[0], row[1]) in seen_right])
corners = left[:, 2:5]
pixels = np.stack([left[:, 5:7], [seen_right[row[0], row[1]] for row in left]], axis=1)  # (corners, 2 cameras, 2)
numbers, image = np.unique(left[:, 0], return_inverse=True)
imu = np.loadtxt(DATA / "imu.csv", delimiter=",", skiprows=1)
imu = imu[np.isin(imu[:, 0], numbers) & (imu[:, 4] == 1)]
at = np.searchsorted(numbers, imu[:, 0])  # the image of each reading

poses = [guess_pose(corners[image == i], pixels[image == i, 0]) for i in range(len(numbers))]
right_pose = guess_pose(corners[image == 0], pixels[image == 0, 1])
up = np.array([poses[i].orient.inverse() * np.array([0, 0, 1]) for i in at])

est = slom.Estimator()
camera = est.variable(StereoCamera(GUESS, GUESS, right_pose.inverse() * poses[0]), "camera")
left2imu = est.variable(guess_rotation(imu[:, 1:4], up), "left2imu")
bias = est.variable(np.zeros(3), "bias")
gravity = est.variable(9.81, "gravity")
left2world = est.variables(poses, "left2world")
est.measure(stereo, camera, left2world[image], corners, measured=pixels, sigma=0.25)
est.measure(level, bias, left2world[at], left2imu, gravity, imu[:, 1:4], sigma=0.05)
fit = est.optimize()

print(f"converged: {fit.converged}, chi-square / dof {fit.chi2_per_dof:.2f}")
print("left camera ", *(f"{x:.4g}" for x in camera.value.left))
print("right camera", *(f"{x:.4g}" for x in camera.value.right))
print("left2right  ", camera.value.left2right.pos.round(4), "m")

# Only the tilts of the head tell gravity from bias, so both are determined weakly.
true = json.loads((DATA / "truth.json").read_text())["imu"]
print(f"gravity      {gravity.value:.4g} +- {gravity.std:.4g}, true {true['gravity']} m/s^2")
for axis, b, std, true_b in zip("xyz", bias.value, bias.std, true["acc_bias"]):
    print(f"bias {axis}       {b:.4g} +- {std:.4g}, true {true_b} m/s^2")
