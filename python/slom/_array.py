import numpy as np


def _comparison(ufunc):
    return lambda self, other: ufunc(self, other, dtype=object)


class Array(np.ndarray):
    """An array of recorded numbers. Its comparisons give arrays of conditions, for slom.where."""

    __lt__ = _comparison(np.less)
    __le__ = _comparison(np.less_equal)
    __gt__ = _comparison(np.greater)
    __ge__ = _comparison(np.greater_equal)
    __eq__ = _comparison(np.equal)
    __ne__ = _comparison(np.not_equal)
    __hash__ = None
