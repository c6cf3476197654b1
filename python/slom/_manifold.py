import dataclasses
from typing import TYPE_CHECKING, Any, Type, TypeVar

import numpy as np

from . import _measured

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

    The perturbation of an instance is those of its fields, in their order: y.boxminus(x) is an array (components,).

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
    """
    made: Any = cls if dataclasses.is_dataclass(cls) else dataclasses.dataclass(cls)
    made.__slom_fields__ = tuple(field.name for field in dataclasses.fields(made))
    made.boxminus = lambda self, other: np.concatenate([np.ravel(x) for x in _flat(_measured.minus(self, other))])
    return made


def _flat(x):
    return [y for entry in x for y in _flat(entry)] if isinstance(x, list) else [x]
