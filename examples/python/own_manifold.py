"""Fits the axis of a turntable to positions of a marker on it: a variable of an own type.

A tracker measures the marker in space while the table turns. The marker moves on a circle. Its centre is a point, its axis a
direction, its radius a number: a manifold of 3 + 2 + 1 = 6 dimensions. Units: metre, radian.
"""

import numpy as np
from numpy.typing import NDArray

import slom

Vector = NDArray[np.float64]


@slom.manifold
class Turntable:
    centre: np.ndarray
    axis: slom.S2
    radius: float

    def miss(self, point: Vector) -> Vector:
        """Returns how far a point is from the circle: along the axis, and away from it."""
        offset = point - self.centre
        height = offset @ self.axis.vector
        return slom.array([height, np.linalg.norm(offset - height * self.axis.vector) - self.radius])


# The truth, and 40 positions on 120 degrees of the circle, with errors of 0.2 mm.
true = Turntable(np.array([1.0, 2.0, 0.5]), slom.S2([0.02, -0.03, 1.0]), 0.4)
SIGMA = 0.0002
rng = np.random.default_rng(4)
angle = np.radians(np.linspace(0, 120, 40))
first = np.cross(true.axis.vector, [1.0, 0, 0])
first /= np.linalg.norm(first)
second = np.cross(true.axis.vector, first)
points = true.centre + true.radius * (np.outer(np.cos(angle), first) + np.outer(np.sin(angle), second))
points += SIGMA * rng.normal(size=points.shape)

est = slom.Estimator()
table = est.variable(Turntable(points.mean(axis=0), slom.S2([0, 0, 1]), 1.0), "table")
est.measure(Turntable.miss, table, points, sigma=SIGMA)
print(est.optimize())

# fitted [-] true is the error in the tangent space, with one component for each of these names.
error = table.value.boxminus(true)
for name, e, std in zip(table.components, error, table.std):
    print(f"{name:15} error {1000 * e:7.3f} +- {1000 * std:.3f} {'mrad' if 'axis' in name else 'mm'}")
print(f"chi-square of all errors: {error @ np.linalg.solve(table.covariance, error):.1f}, where 6 is expected")

# The point of the axis 1 m above the table.
above = est.propagate(lambda t: t.centre + t.axis.vector, table)
print("1 m above:", above.value.round(4), "+-", above.std.round(4), "m")
