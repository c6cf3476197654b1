"""Sparse least squares on manifolds.

    import numpy as np, slom
    est = slom.Estimator()
    centre, radius = est.variable([0, 0], "centre"), est.variable(1.0, "radius")
    est.measure(lambda c, r, p: np.linalg.norm(p - c) - r, centre, radius, points, sigma=0.1)
    print(est.optimize(), centre.value, centre.std)
"""

from ._error import Error, SlowFunctionWarning
from ._manifold import manifold
from ._prior import prior as _prior
from ._propagated import Propagated
from ._slom import (
    Barron,
    Cauchy,
    Condition,
    Estimator,
    Fit,
    FixedLag,
    GemanMcClure,
    Huber,
    Measurements,
    Number,
    PseudoHuber,
    Rows,
    S2,
    SE2,
    SE3,
    SO2,
    SO3,
    Tukey,
    Variable,
    VariableArray,
)
from ._where import where

Estimator.prior = _prior

__all__ = [name for name in dir() if not name.startswith("_")]
