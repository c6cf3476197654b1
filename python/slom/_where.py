import numpy as np

from . import _slom


def where(condition, a, b):
    """Returns `a` where the condition holds, `b` elsewhere: numpy.where that also takes recorded numbers."""
    return np.frompyfunc(_select, 3, 1)(condition, a, b)


def _select(condition, a, b):
    if isinstance(condition, _slom.Condition):
        return _slom._select(condition, _number(a), _number(b))
    return a if condition else b


def _number(x):
    return x if isinstance(x, _slom.Number) else _slom.Number(float(x))
