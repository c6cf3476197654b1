import re

from ._error import Error

# What NumPy says about arrays of objects, which it does not know to be numbers.
_OF_OBJECTS = re.compile(
    r"ufunc .* not supported for the input types|Cannot cast ufunc .* dtype\('O'\)|which has no callable \w+ method"
    r"|object has no attribute '(hypot|arctan2|fmod)'"
)
_OF_FLOATS = re.compile(r"only integers, slices|'float' object cannot be interpreted as an integer|indices must be integers")
_OF_INDICES = re.compile(r"arrays used as indices|only integers, slices")


def call_plain(f, arguments):
    """Calls a measurement function with numbers. Adds the remedy to an error that data as indices cause."""
    try:
        return f(*arguments)
    except (IndexError, TypeError) as error:
        if _OF_FLOATS.search(str(error)):
            raise Error(
                "[slom.float-index] data are passed as floats, which are no indices; write int(k), or look up data before "
                "est.measure and pass the result"
            ) from error
        raise


def call(f, arguments):
    """Calls a measurement function. Adds the remedy to errors of NumPy, which does not know recorded numbers."""
    try:
        return f(*arguments)
    except (AttributeError, IndexError, TypeError) as error:
        if _OF_OBJECTS.search(str(error)):
            raise Error(
                "[slom.traced-array] NumPy cannot compute this with objects, such as recorded numbers in an array made "
                "by np.array; make the array by slom.array"
            ) from error
        if isinstance(error, IndexError) and _OF_INDICES.search(str(error)):
            raise Error(
                "[slom.traced-index] an index or a mask is no plain number; write slom.where(condition, a, b), or "
                "select data before est.measure"
            ) from error
        raise
