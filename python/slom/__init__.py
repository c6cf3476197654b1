"""Sparse least squares on manifolds.

    import numpy as np, slom
    est = slom.Estimator()
    centre, radius = est.variable([0, 0], "centre"), est.variable(1.0, "radius")
    est.measure(lambda c, r, p: np.linalg.norm(p - c) - r, centre, radius, points, sigma=0.1)
    print(est.optimize(), centre.value, centre.std)
"""

from . import _functions  # noqa: F401  (tells NumPy what to do with recorded numbers)
from ._array import array
from ._slom import Condition, Error, Estimator, Number, Summary, Variable
from ._where import where

__all__ = ["Condition", "Error", "Estimator", "Number", "Summary", "Variable", "array", "where"]
