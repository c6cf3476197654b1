"""What the command writes as JSON, with attributes."""

import difflib

import numpy as np

from ._slom import SE3, SO3, Rows


class Record(dict):
    """An object of JSON. `record["key"]` is the value as it stands there, `record.key` is converted:

    numbers     lists become arrays, of nan for null; 9 numbers of a rotation become a 3 x 3 matrix
    columns     if all entries are objects, `record.key` is the array of what `key` is in each
    se3         the slom.SE3 of the keys `rotation` and `translation`
    """

    def __getattr__(self, name):
        if name in self:
            return _converted(name, self[name])
        if name == "se3" and "rotation" in self and "translation" in self:
            return SE3(self.translation, SO3(self.rotation))
        return _column(name, list(self.values()), self)

    def __dir__(self):
        return [*super().__dir__(), *self]


class Records(list):
    """A list of JSON. If its entries are objects, `records.key` is the array of what `key` is in each."""

    def __getattr__(self, name):
        return _column(name, self, self[0] if self and isinstance(self[0], Record) else {})

    def __getitem__(self, index):
        some = super().__getitem__(index)
        return Records(some) if isinstance(index, slice) else some

    def __dir__(self):
        return [*super().__dir__(), *(self[0] if self and isinstance(self[0], dict) else ())]


def _column(name, rows, known):
    if not name.startswith("__") and rows and all(isinstance(row, Record) for row in rows):
        return _stacked([getattr(row, name) for row in rows])
    near = difflib.get_close_matches(name, [key for key in known if isinstance(key, str)], 3) or list(known)
    raise AttributeError(f"there is no {name}" + (f"; there are {', '.join(near)}" if near else ""))


def _converted(name, value):
    if not isinstance(value, list):
        return value
    if not _is_numeric(value):
        return Records(value)
    array = np.array(_without_none(value), float if _has_none_or_float(value) else None)
    return array.reshape(3, 3) if name.startswith("rotation") and array.shape == (9,) else array


def _stacked(values):
    if isinstance(values[0], SE3):
        return Rows(values)
    if all(isinstance(x, np.ndarray) and x.shape == values[0].shape for x in values):
        return np.array(values)
    if _is_numeric(values):
        return np.array(_without_none(values), float if _has_none_or_float(values) else None)
    return Records(values)


def _is_numeric(values):
    """Whether these are numbers or null, or lists of one length of these."""
    if values and all(isinstance(x, list) for x in values):
        return all(len(x) == len(values[0]) for x in values) and all(map(_is_numeric, values))
    return bool(values) and all(x is None or (isinstance(x, (int, float)) and not isinstance(x, bool)) for x in values)


def _without_none(values):
    return [_without_none(x) if isinstance(x, list) else np.nan if x is None else x for x in values]


def _has_none_or_float(values):
    return any(_has_none_or_float(x) if isinstance(x, list) else not isinstance(x, int) for x in values)
