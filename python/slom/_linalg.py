"""Linear algebra of small matrices of recorded numbers."""

import numpy as np

from ._array import array, is_recorded
from ._refused import refuse


def norm(x, ord=None, axis=None, keepdims=False):
    """numpy.linalg.norm."""
    x = array(x)
    if axis is None:
        if ord is None:
            total = np.sqrt(np.sum(x * x))
            return np.reshape(total, [1] * x.ndim) if keepdims else total
        axis = tuple(range(x.ndim))
    axes = axis if isinstance(axis, tuple) else (axis,)
    if len(axes) == 1:
        return _vector_norm(x, ord, axes[0], keepdims)
    if ord in (None, "fro", "f"):
        return np.sqrt(np.sum(x * x, axis=axes, keepdims=keepdims))
    if ord not in (1, -1, np.inf, -np.inf):
        _refuse_order()
    along, across = axes if abs(ord) == 1 else axes[::-1]
    sums = np.sum(abs(x), axis=along, keepdims=True)
    total = (np.max if ord > 0 else np.min)(sums, axis=across, keepdims=True)
    return total if keepdims else np.squeeze(total, axis=axes)


def _vector_norm(x, ord, axis, keepdims):
    options = {"axis": axis, "keepdims": keepdims}
    if ord in (None, 2):
        return np.sqrt(np.sum(x * x, **options))
    if ord == 1:
        return np.sum(abs(x), **options)
    if ord == np.inf:
        return np.max(abs(x), **options)
    if ord == -np.inf:
        return np.min(abs(x), **options)
    if isinstance(ord, str) or ord == 0:
        _refuse_order()
    return np.sum(abs(x) ** ord, **options) ** (1 / ord)


def _refuse_order():
    refuse(
        "np.linalg.norm of this order",
        "use a number other than 0 or np.inf for vectors, and 'fro', 1 or np.inf for matrices",
    )


def determinant(a):
    """numpy.linalg.det."""
    a = _small(a, "np.linalg.det")
    everything = tuple(range(a.shape[-1]))
    return _minor(a, everything, everything)


def inverse(a):
    """numpy.linalg.inv: the adjugate over the determinant."""
    a = _small(a, "np.linalg.inv")
    n = a.shape[-1]
    without = [tuple(k for k in range(n) if k != i) for i in range(n)]
    adjugate = np.empty_like(a)
    for i in range(n):
        for j in range(n):
            adjugate[..., j, i] = (-1) ** (i + j) * _minor(a, without[i], without[j])
    return adjugate / determinant(a)[..., None, None] if a.ndim > 2 else adjugate / determinant(a)


def solve(a, b):
    """numpy.linalg.solve."""
    if not is_recorded(a):
        return np.linalg.inv(a) @ b
    return inverse(_small(a, "np.linalg.solve")) @ b


def _small(a, name):
    a = array(a)
    if a.ndim < 2 or a.shape[-1] != a.shape[-2] or a.shape[-1] > 4:
        refuse(
            f"{name} of a matrix of shape {' x '.join(map(str, a.shape))}",
            "use up to 4 rows, or make the result a variable and return a @ x - b as the residual",
        )
    return a


def _minor(a, rows, columns):
    """Returns the determinant of the chosen rows and columns, expanded along the first row."""
    if not rows:
        return 1.0
    return sum(
        (-1) ** k * a[..., rows[0], column] * _minor(a, rows[1:], columns[:k] + columns[k + 1 :])
        for k, column in enumerate(columns)
    )
