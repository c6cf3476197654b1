import dataclasses
from typing import Type, TypeVar

import numpy as np

from . import _measured


T = TypeVar("T")


def manifold(cls: Type[T]) -> Type[T]:
    """Makes a class a type of variables and data. Its annotated fields are numbers, arrays, SO2, SO3, S2, SE2, SE3, or
    instances of other such classes. The class becomes a dataclass if it is not one.

        @slom.manifold
        class Camera:
            pose: slom.SE3
            focal_length: float
            distortion: np.ndarray
    """
    if not dataclasses.is_dataclass(cls):
        cls = dataclasses.dataclass(cls)
    cls.__slom_fields__ = tuple(field.name for field in dataclasses.fields(cls))
    cls.boxminus = lambda self, other: np.concatenate([np.ravel(x) for x in _flat(_measured.minus(self, other))])
    return cls


def _flat(x):
    return [y for entry in x for y in _flat(entry)] if isinstance(x, list) else [x]
