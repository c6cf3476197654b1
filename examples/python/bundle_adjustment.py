"""Bundle adjustment: finds cameras and points in space from the pixels at which the cameras see the points.

    bundle_adjustment.py [FILE]

FILE has the format of "Bundle adjustment in the large", as docs/bundle_files.md describes it. The default is the simulated scene
data/simulated_bundle, whose pixels have errors of 0.5 px. The command `slom bundle` fits the same files.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import slom

Vector = NDArray[np.float64]
SIGMA_PX = 0.5


@slom.manifold
class Camera:
    pose: slom.SE3  # camera_T_world; the camera looks along -z
    f: float  # focal length [px]
    k: np.ndarray  # radial distortion (2,)


def pixel(camera: Camera, point: Vector) -> Any:
    """Returns the pixel (2,) at which a camera sees a point (3,)."""
    x, y, z = camera.pose * point
    u = slom.array([-x / z, -y / z])
    r2 = np.sum(u * u)
    return camera.f * (1 + camera.k[0] * r2 + camera.k[1] * r2 * r2) * u


# The file: three counts; camera, point, u, v for each observation; 9 numbers for each camera; 3 numbers for each point.
file = sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parents[2] / "data/simulated_bundle/scene.txt"
numbers = np.array(Path(file).read_text().split(), float)
cameras, points, observations = numbers[:3].astype(int)
seen, rest = numbers[3 : 3 + 4 * observations].reshape(-1, 4), numbers[3 + 4 * observations :]
i, j, measured = seen[:, 0].astype(int), seen[:, 1].astype(int), seen[:, 2:]
start = rest[: 9 * cameras].reshape(-1, 9)
start_points = rest[9 * cameras :].reshape(-1, 3)

est = slom.Estimator()
camera = est.variables([Camera(slom.SE3(c[3:6], slom.SO3.exp(c[:3])), c[6], c[7:9]) for c in start], "camera")
point = est.variables(start_points, "point")
pixels = est.measure(pixel, camera[i], point[j], measured=measured, sigma=SIGMA_PX)
print(f"{cameras} cameras, {points} points, {observations} observations")
print(f"before: rms {np.sqrt(np.mean(pixels.residuals**2)):.3f} px")

# Place, rotation and scale of the whole are free. Levenberg-Marquardt holds them by its damping.
est.use_algorithm("lm", memory=0.1)
fit = est.optimize()
print(f"after:  rms {np.sqrt(np.mean(pixels.residuals**2)):.3f} px, converged: {fit.converged}")
print(f"chi-square / dof {fit.chi2_per_dof:.3f}: the errors have {SIGMA_PX * np.sqrt(fit.chi2_per_dof):.2f} px")

# What does not depend on place, rotation and scale can be compared with the truth.
if len(sys.argv) == 1:
    est.free_gauge = "inner_constraints"
    for k, (f, std) in enumerate(zip(camera.value.f, camera.std[:, 6])):
        print(f"focal length {f:.1f} +- {std:.1f} px, true {500 + 10 * k} px")
