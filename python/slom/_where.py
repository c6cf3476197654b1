from typing import Any, overload

import numpy as np

from ._array import is_recorded, result
from ._slom import Condition, Number, _select


@overload
def where(condition: bool, a: float, b: float) -> float: ...
@overload
def where(condition: Any, a: Any, b: Any) -> Any: ...
def where(condition: Any, a: Any, b: Any) -> Any:
    """Returns `a` where the condition holds, `b` elsewhere: numpy.where that also takes recorded numbers.

    In a measurement function it stands in place of `if`. The derivative is that of the chosen side.

    >>> def hinge(x, knee, slope):
    ...     return slom.where(x < knee, 0.0, slope * (x - knee))
    >>> print(hinge(np.array([0.0, 1.0, 3.0]), 1.0, 2.0))
    [0. 0. 4.]
    """
    if not any(is_recorded(np.asarray(x)) for x in (condition, a, b)):
        return np.where(condition, a, b)[()]
    return result(_chosen(condition, a, b))


def choose(condition, a, b):
    """Returns one of two numbers."""
    if isinstance(condition, Number):
        condition = condition != 0
    if isinstance(condition, Condition):
        return _select(condition, number(a), number(b))
    return a if condition else b


def number(x):
    """Returns a number as a recorded one."""
    return x if isinstance(x, Number) else Number(float(x))


_chosen = np.frompyfunc(choose, 3, 1)
