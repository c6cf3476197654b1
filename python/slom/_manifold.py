import dataclasses
from typing import TYPE_CHECKING, Any, Type, TypeVar

import numpy as np

from . import _measured
from ._error import Error

if TYPE_CHECKING:
    from typing_extensions import dataclass_transform
else:

    def dataclass_transform():
        return lambda f: f


T = TypeVar("T")


@dataclass_transform()
def manifold(cls: Type[T]) -> Type[T]:
    """Makes a class a type of variables and data. Its annotated fields are numbers, arrays, SO2, SO3, S2, SE2, SE3, or
    instances of other such classes. The class becomes a dataclass if it is not one.

    The perturbation of an instance is those of its fields, in their order: y.boxminus(x), or y - x, is an array
    (components,), and x.boxplus(d), or x + d, applies one.

    >>> @slom.manifold
    ... class Line:
    ...     point: np.ndarray
    ...     direction: slom.S2
    >>> est = slom.Estimator()
    >>> line = est.variable(Line(np.zeros(3), slom.S2([0, 0, 1])), "line")
    >>> line.components
    ['line.point.x', 'line.point.y', 'line.point.z', 'line.direction.0', 'line.direction.1']
    >>> print(Line(np.ones(3), slom.S2([0, 0, 1])).boxminus(line.value))
    [1. 1. 1. 0. 0.]
    >>> (line.value + [0, 0, 2, 0, 0]).point
    array([0., 0., 2.])
    """
    made: Any = cls if dataclasses.is_dataclass(cls) else dataclasses.dataclass(cls)
    made.__slom_fields__ = tuple(field.name for field in dataclasses.fields(made))
    made.boxminus = lambda self, other: np.concatenate([np.ravel(x) for x in _flat(_measured.minus(self, other))])
    made.boxplus = _boxplus
    for operator, method in (("__sub__", made.boxminus), ("__add__", made.boxplus)):
        if operator not in vars(made):
            setattr(made, operator, method)
    return made


def _boxplus(self, d):
    d = np.asarray(d)
    moved, used = _moved(self, d, 0)
    if used != d.size:
        raise Error(
            f"[slom.wrong-shape] a perturbation of {type(self).__name__} needs {used} numbers, it was given {d.size}; pass an "
            "array of that length",
            type(self).__name__,
        )
    return moved


_DOF = {"SO2": 1, "S2": 2, "SO3": 3, "SE2": 3, "SE3": 6}


def _moved(x, d, at):
    """Returns x [+] the numbers of d from `at` on, and the place after them."""
    if hasattr(type(x), "__slom_fields__"):
        moved = object.__new__(type(x))
        for name in type(x).__slom_fields__:
            value, at = _moved(getattr(x, name), d, at)
            object.__setattr__(moved, name, value)
        return moved, at
    dof = _DOF.get(type(x).__name__.replace("Recorded", ""))
    end = at + (np.size(x) if dof is None else dof)
    own = d[at:end]
    if len(own) < end - at:
        return x, end  # the caller says so
    if dof is not None:
        return x.boxplus(own), end
    return (x + np.reshape(own, np.shape(x)) if np.ndim(x) else x + own[0]), end


def _flat(x):
    return [y for entry in x for y in _flat(entry)] if isinstance(x, list) else [x]
