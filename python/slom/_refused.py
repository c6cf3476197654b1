"""The sentences for functions of NumPy that cannot be recorded: which function, and what to write instead."""

from ._error import Error

_SORT = "sort and select data before est.measure; for recorded numbers, use np.maximum, np.minimum or slom.where"
_LOOK_UP = "look up data before est.measure and pass the result as an argument"
_FINITE = "remove rows that are not finite before est.measure"
_BRANCH = "write slom.where(condition, a, b)"
_COMPARE = "compare with == or <, and pass the condition to slom.where"
_FACTORS = "make the factors variables and return the defining equations as residuals"
_ROUND = "use np.floor(x + 0.5)"
_REST = "write it with operators, slom.where and the functions of docs/python_functions.md"

_REMEDIES = {
    _SORT: "argmax argmin argpartition argsort lexsort median partition percentile quantile searchsorted sort "
    "sort_complex unique intersect1d union1d setdiff1d isin in1d",
    _LOOK_UP: "bincount choose digitize histogram histogram2d histogramdd searchsorted take_along_axis",
    _FINITE: "isfinite isinf isnan isnat nan_to_num nanmax nanmean nanmedian nanmin nanstd nansum nanvar",
    _BRANCH: "argwhere count_nonzero extract flatnonzero nonzero piecewise place putmask trim_zeros",
    _COMPARE: "allclose array_equal array_equiv isclose",
    _FACTORS: "cholesky eig eigh eigvals eigvalsh lstsq pinv qr svd roots matrix_rank cond slogdet polyfit",
    _ROUND: "around rint round",
    "interpolate data before est.measure, or write the pieces with slom.where": "interp",
    "write start + (stop - start) * np.linspace(0, 1, n)": "linspace",
    "use np.trunc(x) and x - np.trunc(x)": "modf",
    "add 2 * np.pi * n with n from data, or return np.sin and np.cos of the angle": "unwrap",
    "write x < 0": "signbit",
    "use np.clip(x, low, high)": "clip",
    "use np.array and @": "matrix",
}
_REMEDY_OF = {name: remedy for remedy, names in _REMEDIES.items() for name in names.split()}


def remedy(name):
    return _REMEDY_OF.get(name.rpartition(".")[2], _REST)


def refuse(name, instead=None):
    """Raises the sentence for a function."""
    raise Error(f"[slom.traced-function] {name} does not take recorded numbers; {instead or remedy(name)}")
