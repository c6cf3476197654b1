"""Sparse least squares on manifolds.

    import numpy as np, slom
    est = slom.Estimator()
    centre, radius = est.variable([0, 0], "centre"), est.variable(1.0, "radius")
    est.measure(lambda c, r, p: np.linalg.norm(p - c) - r, centre, radius, points, sigma=0.1)
    print(est.optimize(), centre.value, centre.std)
"""

from . import _functions  # tells NumPy what to do with recorded numbers
from ._array import array
from ._curve_fit import CurveFit, curve_fit
from ._error import Error, SlowFunctionWarning
from ._files import BalCamera, Bundle, PoseGraph, read_bal, read_g2o
from ._manifold import manifold
from ._propagated import Propagated
from ._results import BundleFit, Calibration, GraphFit, Replay, bundle, calibrate, graph, replay
from ._slom import (
    Barron,
    Cauchy,
    Clustered,
    Condition,
    DerivativeCheck,
    Diagnosis,
    Estimator,
    Fit,
    FixedLag,
    GemanMcClure,
    Huber,
    IntervalTable,
    Measurements,
    Number,
    OutlierReport,
    Preflight,
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
    VarianceComponents,
    __version__,
    load,
)
from ._where import where

read_archive = load

__all__ = [
    "array",
    "BalCamera",
    "Barron",
    "Bundle",
    "bundle",
    "BundleFit",
    "calibrate",
    "Calibration",
    "Cauchy",
    "Clustered",
    "Condition",
    "curve_fit",
    "CurveFit",
    "DerivativeCheck",
    "Diagnosis",
    "Error",
    "Estimator",
    "Fit",
    "FixedLag",
    "GemanMcClure",
    "graph",
    "GraphFit",
    "Huber",
    "IntervalTable",
    "load",
    "manifold",
    "Measurements",
    "Number",
    "OutlierReport",
    "PoseGraph",
    "Preflight",
    "Propagated",
    "PseudoHuber",
    "read_archive",
    "read_bal",
    "read_g2o",
    "Replay",
    "replay",
    "Rows",
    "S2",
    "SE2",
    "SE3",
    "SlowFunctionWarning",
    "SO2",
    "SO3",
    "Tukey",
    "Variable",
    "VariableArray",
    "VarianceComponents",
    "where",
]
