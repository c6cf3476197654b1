"""Arrays of recorded numbers. NumPy's functions of them are in _functions.py."""

import numbers
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._refused import refuse
from ._slom import Condition, Error, Number


class Array(np.ndarray):
    """An array of recorded numbers, or of conditions on them."""

    # NumPy 1.24 swallows errors of its own ==.
    def __eq__(self, other):
        return np.equal(self, other)

    def __ne__(self, other):
        return np.not_equal(self, other)

    __hash__ = None

    def __getitem__(self, index):
        _check_index(index)
        return super().__getitem__(index)

    def __setitem__(self, index, value):
        _check_index(index)
        super().__setitem__(index, value)

    def __deepcopy__(self, memo):
        return self.copy()

    def clip(self, *arguments, **options):
        return np.clip(self, *arguments, **options)

    def astype(self, dtype, *options, **named_options):
        dtype = np.dtype(dtype)
        if dtype not in (np.dtype(float), np.dtype(object)):
            refuse("x.astype", "use np.floor or np.trunc for integers, and drop other conversions")
        return self.copy() if dtype == object else self + 0.0


def _refused_method(name):
    def method(self, *arguments, **options):
        refuse(f"x.{name}")

    return method


for _name in ("argmax", "argmin", "argsort", "sort", "searchsorted", "partition", "argpartition", "nonzero", "round"):
    setattr(Array, _name, _refused_method(_name))


def array(values: Any) -> NDArray[np.float64]:
    """Returns numpy.array(values). Entries may be recorded numbers, which np.array would keep as mere objects.

    Measurement functions make arrays of the numbers that they compute by it:

    >>> def polar(point):
    ...     return slom.array([np.hypot(point[0], point[1]), np.arctan2(point[1], point[0])])
    >>> print(polar(np.array([0.0, 2.0])).round(3))
    [2.    1.571]
    """
    a = np.array(values)
    return recorded(a) if a.dtype == object else a


def recorded(a):
    """Returns the array, or the number, as an Array. Numbers become recorded ones; conditions and bools stay."""
    a = np.asarray(a)
    if all(isinstance(x, (Number, Condition, bool)) for x in a.flat):
        return a.astype(object, copy=False).view(Array)
    entries = np.empty(a.shape, object)
    entries[...] = _entries(a)
    return entries.view(Array)


def result(x):
    """Returns what NumPy computed from arrays of objects: an Array, or the number in an array without dimensions."""
    if isinstance(x, (tuple, list)):
        return type(x)(map(result, x))
    if not isinstance(x, np.ndarray) or x.dtype != object:
        return x
    return x.view(Array) if x.ndim else x[()]


def is_recorded(x):
    """Returns whether an argument is a recorded number, a condition, or an array that may hold such."""
    return isinstance(x, (Number, Condition)) or (isinstance(x, np.ndarray) and x.dtype == object)


def _entry(x):
    if isinstance(x, (Number, Condition, bool)):
        return x
    if isinstance(x, numbers.Real):
        return Number(float(x))
    if isinstance(x, numbers.Complex):
        return complex(Number.__complex__(Number(0)))
    raise Error(
        f"[slom.traced-entry] an array of recorded numbers has an entry of type {type(x).__name__}; "
        "pass numbers, all rows of one length"
    )


_entries = np.frompyfunc(_entry, 1, 1)


def _check_index(index):
    for one in index if isinstance(index, tuple) else (index,):
        if is_recorded(one) or (isinstance(one, list) and any(map(is_recorded, one))):
            raise Error(
                "[slom.traced-index] an index or a mask depends on recorded numbers; write "
                "slom.where(condition, a, b), or select data before est.measure"
            )


# np.isscalar(x) holds for recorded numbers, too.
numbers.Real.register(Number)
