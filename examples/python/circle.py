"""Fits a circle to points with errors of 0.1 m: the program of the README, and the analyses that follow a fit.

Unit: metre. The C++ program is examples/circle_fit.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

import slom

Vector = NDArray[np.float64]
POINTS = np.array([[3.9, 1.0], [3.1, 3.2], [1.0, 4.1], [-1.1, 3.0], [-2.0, 1.1], [-1.2, -1.1], [0.9, -2.0]])


def distance(centre: Vector, radius: float, point: Vector) -> Any:
    """Returns the distance of a point from the circle."""
    return np.linalg.norm(point - centre) - radius


est = slom.Estimator()
centre = est.variable([0, 0], "centre")
radius = est.variable(1.0, "radius")
est.measure(distance, centre, radius, POINTS, sigma=0.1)
print(est.optimize())

area = est.propagate(lambda r: np.pi * r**2, radius)
print(f"area {area.value:.2f} +- {area.std:.2f} m^2\n")
print(est.intervals())

# A gross error of 1 m in one point: the test names the point.
wrong = POINTS + [[0, 0], [0, 0], [0, 0], [0, 1], [0, 0], [0, 0], [0, 0]]
est = slom.Estimator()
centre = est.variable([0, 0], "centre")
radius = est.variable(1.0, "radius")
distances = est.measure(distance, centre, radius, wrong, sigma=0.1)
est.optimize()
print(est.outliers(worst=1))
print(f"least squares: radius {radius.value:.2f} +- {radius.std:.2f} m")

# A robust loss keeps the point, with a small weight.
distances.remove()
distances = est.measure(distance, centre, radius, wrong, sigma=0.1, loss=slom.Cauchy(1))
est.optimize()
print(f"Cauchy's loss: radius {radius.value:.2f} +- {radius.std:.2f} m, weight of the point {distances.weights[3]:.2f}")
