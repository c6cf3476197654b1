"""What NumPy's functions do with recorded numbers. A function that is not named here is refused: NumPy would compute
with objects, and might ask for values, or give a wrong result without a word."""

import operator
from typing import Any, Dict

import numpy as np

from . import _linalg
from ._array import Array, array, is_recorded, recorded, result
from ._refused import refuse
from ._slom import Condition, Error, Number
from ._where import choose, number, where


def _maximum(a, b):
    return choose(a < b, b, a)


def _minimum(a, b):
    return choose(b < a, b, a)


def _copysign(x, y):
    return choose(y < 0, -abs(x), abs(x))


def _heaviside(x, at_zero):
    return choose(x < 0, 0.0, choose(x > 0, 1.0, at_zero))


def _logaddexp(a, b):
    return choose(a < b, b, a) + number(-abs(b - a)).exp().log1p()


def _logaddexp2(a, b):
    return _logaddexp(a * np.log(2), b * np.log(2)) / np.log(2)


def _expit(x):
    e = number(choose(x < 0, x, -x)).exp()  # does not overflow
    return choose(x < 0, e, 1.0) / (1 + e)


def _normal(x):
    return 0.5 * number(-x * np.sqrt(0.5)).erfc()


def _logit(x):
    return number(x).log() - number(-x).log1p()


def _xlogy(x, y):
    return x * number(choose((x == 0) & _not(y > 0), 1.0, y)).log()


def _truth(x):
    return x if isinstance(x, (Condition, bool)) else x != 0


def _not(x):
    return not x if isinstance(x, bool) else ~x


def _method(name):
    return lambda x, *others: getattr(number(x), name)(*others)


def _elementwise(function, count, **identity):
    return np.frompyfunc(function, count, 1, **identity)


_AND = _elementwise(lambda a, b: _truth(a) & _truth(b), 2, identity=True)
_OR = _elementwise(lambda a, b: _truth(a) | _truth(b), 2, identity=False)
_XOR = _elementwise(lambda a, b: _truth(a) ^ _truth(b), 2, identity=False)
_NOT = _elementwise(lambda a: _not(_truth(a)), 1)
_MAXIMUM = _elementwise(_maximum, 2, identity=None)
_MINIMUM = _elementwise(_minimum, 2, identity=None)

# Functions of NumPy whose loops over objects are right.
_ARITHMETIC = (
    "add subtract multiply divide negative positive power absolute floor ceil floor_divide remainder square reciprocal "
    "matmul vecdot matvec vecmat conjugate"
)
_UFUNCS = {
    **{name: getattr(np, name) for name in _ARITHMETIC.split() if hasattr(np, name)},
    **{name: _AND for name in ("logical_and", "bitwise_and")},
    **{name: _OR for name in ("logical_or", "bitwise_or")},
    **{name: _XOR for name in ("logical_xor", "bitwise_xor")},
    **{name: _NOT for name in ("logical_not", "invert")},
    **{name: _MAXIMUM for name in ("maximum", "fmax")},
    **{name: _MINIMUM for name in ("minimum", "fmin")},
    "less": _elementwise(operator.lt, 2),
    "less_equal": _elementwise(operator.le, 2),
    "greater": _elementwise(operator.gt, 2),
    "greater_equal": _elementwise(operator.ge, 2),
    "equal": _elementwise(operator.eq, 2),
    "not_equal": _elementwise(operator.ne, 2),
    "float_power": _elementwise(operator.pow, 2),
    "divmod": np.frompyfunc(divmod, 2, 2),
    "copysign": _elementwise(_copysign, 2),
    "heaviside": _elementwise(_heaviside, 2),
    "logaddexp": _elementwise(_logaddexp, 2),
    "logaddexp2": _elementwise(_logaddexp2, 2),
    **{name: _elementwise(_method(name), 2) for name in ("hypot", "arctan2", "fmod")},
    # SciPy's special functions.
    "expit": _elementwise(_expit, 1),
    "logit": _elementwise(_logit, 1),
    "ndtr": _elementwise(_normal, 1),
    "xlogy": _elementwise(_xlogy, 2),
    **{
        name: _elementwise(_method(name), 1)
        for name in (
            "sqrt cbrt sin cos tan arcsin arccos arctan sinh cosh tanh arcsinh arccosh arctanh exp exp2 expm1 log "
            "log1p log10 log2 erf erfc fabs sign trunc deg2rad radians rad2deg degrees"
        ).split()
    },
}

# A masked reduction of objects needs a start.
_INITIAL = {"add": 0.0, "multiply": 1.0, "logical_and": True, "logical_or": False}


def apply_ufunc(ufunc, method, inputs, options):
    """Computes ufunc.method(*inputs) for inputs of which at least one is recorded."""
    name = ufunc.__name__ if getattr(np, ufunc.__name__, None) is not ufunc else "np." + ufunc.__name__
    takes_objects_only = all(set(loop) <= set("O->") for loop in ufunc.types)
    own = ufunc if takes_objects_only else _UFUNCS.get(ufunc.__name__)
    if own is None:
        refuse(name)
    _check_matrix(inputs)
    if method == "at":
        refuse(name + ".at", "write x[i] = ... for each index")
    if is_recorded(options.get("where", True)) or ("where" in options and method == "__call__"):
        refuse(name + " with where=", "write slom.where(condition, a, b)")
    for key in ("dtype", "casting", "order", "subok", "signature"):
        options.pop(key, None)
    out = options.pop("out", None)
    if out is not None:
        _check_out(name, out)
        options["out"] = tuple(map(_plain, out))
    if "where" in options:
        options.setdefault("initial", _INITIAL.get(ufunc.__name__, np._NoValue))
    exponent = inputs[-1]
    count = len(inputs) if method in ("__call__", "outer") else 1  # the others are indices
    inputs = [_plain(x) if takes_objects_only else recorded(x).view(np.ndarray) for x in inputs[:count]] + list(
        inputs[count:]
    )
    if ufunc in (np.power, np.float_power) and len(inputs) == 2 and not is_recorded(exponent):
        inputs[1] = np.asarray(exponent, float).astype(object)  # stays part of the formula
    computed = getattr(own, method)(*inputs, **options)
    return result(computed) if out is None else out[0] if len(out) == 1 else out


def _plain(x):
    return np.asarray(x) if is_recorded(x) else x


def _check_matrix(arguments):
    if any(isinstance(x, np.matrix) for x in arguments):
        refuse("np.matrix")


def _check_out(name, out):
    for x in out:
        if x is not None and x.dtype != object:
            raise Error(
                f"[slom.traced-out] {name} cannot store recorded numbers in an array of {x.dtype}; make the array by "
                "np.zeros(n, dtype=object), or write a = a + b for a += b"
            )


def _einsum(subscripts, *operands, **options):
    """numpy.einsum without an ellipsis. NumPy 1.24 has none for objects."""
    if not isinstance(subscripts, str) or "." in subscripts:
        refuse("np.einsum with an ellipsis or lists of axes", 'name all axes, as in np.einsum("ij,j->i", A, x)')
    given, _, kept = subscripts.replace(" ", "").partition("->")
    terms = given.split(",")
    letters = sorted(set(given) - {","})
    if "->" not in subscripts:
        kept = "".join(c for c in letters if given.count(c) == 1)
    order = kept + "".join(c for c in letters if c not in kept)
    product = 1.0
    for term, x in zip(terms, map(recorded, operands)):
        own = "".join(c for c in order if c in term)
        places = np.einsum(f"{term}->{own}", np.arange(x.size).reshape(x.shape))  # diagonals and transposes
        shape = iter(places.shape)
        product = product * x.ravel()[places].reshape([next(shape) if c in own else 1 for c in order])
    return product.sum(axis=tuple(range(len(kept), len(order)))) if len(order) > len(kept) else product


def _select(conditions, choices, default=0):
    chosen = default
    for condition, choice in reversed(list(zip(conditions, choices))):
        chosen = where(condition, choice, chosen)
    return chosen


def _where(condition, *sides):
    if len(sides) != 2:
        refuse("np.where of a condition alone", "write np.where(condition, a, b)")
    return where(condition, *sides)


def _like(function):
    def like(a, *arguments, **options):
        made = function._implementation(a.view(np.ndarray), *arguments, **options)
        return made.view(Array) if made.dtype == object else made

    return like


def _copyto(to, *arguments, **options):
    np.copyto._implementation(_plain(to), *map(_plain, arguments), **options)


def _clip_function(x, a_min=None, a_max=None, out=None, *, min=None, max=None):
    """numpy.clip, which asks for NaN in NumPy 1.24."""
    low, high = (a if a is not None else b for a, b in ((a_min, min), (a_max, max)))
    bounded = x if low is None else np.maximum(x, low)
    bounded = bounded if high is None else np.minimum(bounded, high)
    return np.positive(bounded, out=out) if out is not None else bounded


def _sinc(x):
    y = np.pi * x
    y = where(y == 0, 1e-20, y)
    return np.sin(y) / y


_OWN: Dict[Any, Any] = {
    np.where: _where,
    np.select: _select,
    np.einsum: _einsum,
    np.fix: lambda x: np.trunc(x),
    np.sinc: _sinc,
    np.clip: _clip_function,
    np.copyto: _copyto,
    **{function: _like(function) for function in (np.empty_like, np.zeros_like, np.ones_like, np.full_like)},
    np.linalg.norm: _linalg.norm,
    np.linalg.det: _linalg.determinant,
    np.linalg.inv: _linalg.inverse,
    np.linalg.solve: _linalg.solve,
}

# Functions that NumPy writes with operators, slices and the functions above.
_WRITTEN = {
    getattr(np, name)
    for name in (
        "all amax amin any append apply_along_axis array2string array_repr array_split array_str atleast_1d atleast_2d "
        "atleast_3d average block broadcast_arrays broadcast_to column_stack concatenate convolve copy "
        "correlate cross cumprod cumsum delete diag diagflat diagonal diff dot dsplit dstack ediff1d "
        "expand_dims flip fliplr flipud hsplit hstack inner insert iscomplexobj isrealobj kron max mean "
        "meshgrid min moveaxis ndim outer polyval prod ptp ravel real repeat reshape resize roll rollaxis "
        "rot90 shape size split squeeze stack std sum swapaxes take tensordot tile trace transpose trapezoid "
        "trapz tril triu var vdot vsplit vstack "
    ).split()
    if hasattr(np, name)
} | {np.linalg.matrix_power, np.linalg.multi_dot}


def apply_function(function, arguments, options):
    """Computes a function of NumPy for arguments of which at least one is recorded."""
    own = _OWN.get(function)
    if own is None and function not in _WRITTEN:
        refuse(f"{function.__module__}.{function.__name__}".replace("numpy.", "np.", 1).rstrip("_"))
    _check_matrix(arguments)
    converted = [_argument(x) for x in arguments]
    options = {name: x if name == "out" else _argument(x) for name, x in options.items()}
    computed = (own or function._implementation)(*converted, **options)
    for given, used in zip(arguments, converted):
        if computed is used and isinstance(given, np.ndarray) and not isinstance(given, Array):  # an output
            given[...] = computed
    return result(computed)


def _argument(x):
    """Returns an argument with numbers as arrays, so that what NumPy writes with asanyarray(x) comes back here."""
    if is_recorded(x):
        return recorded(x)
    if isinstance(x, (list, tuple)) and any(map(_holds_recorded, x)):
        return array(x) if all(np.ndim(entry) == 0 for entry in x) else [_argument(entry) for entry in x]
    return x


def _holds_recorded(x):
    return is_recorded(x) or (isinstance(x, (list, tuple)) and any(map(_holds_recorded, x)))


def _array_ufunc(self, ufunc, method, *inputs, **options):
    return apply_ufunc(ufunc, method, inputs, options)


def _array_function(self, function, types, arguments, options):
    return apply_function(function, arguments, options)


# Numbers alone come here, too: np.float64(2) - x, np.where(x > 0, x, 0).
_type: Any
for _type in (Array, Number, Condition):
    _type.__array_ufunc__ = _array_ufunc
    _type.__array_function__ = _array_function
