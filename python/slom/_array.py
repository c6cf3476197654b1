import numpy as np


class Array(np.ndarray):
    """An array of recorded numbers. Its comparisons give arrays of conditions, for slom.where."""

    def __lt__(self, other):
        return np.less(self, other, dtype=object)

    def __le__(self, other):
        return np.less_equal(self, other, dtype=object)

    def __gt__(self, other):
        return np.greater(self, other, dtype=object)

    def __ge__(self, other):
        return np.greater_equal(self, other, dtype=object)

    def __eq__(self, other):
        return np.equal(self, other, dtype=object)

    def __ne__(self, other):
        return np.not_equal(self, other, dtype=object)

    __hash__ = None
