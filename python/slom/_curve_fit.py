import functools
import inspect
import warnings
from typing import Any, Callable, Dict, Iterator, Optional, Sequence, Tuple, TypeVar, cast, overload

import numpy as np
from numpy.typing import ArrayLike

from ._error import Error
from ._slom import Estimator, Fit, Interval, IntervalTable, Loss, Variable


class CurveFit:
    """A fitted curve. Unpacks to popt, pcov as the result of scipy.optimize.curve_fit does.

    popt, pcov   values and covariance of the parameters
    perr         standard deviations
    names        names of the parameters
    fit          the report: chi-square, warnings, correlations
    """

    def __init__(
        self, f: Callable[..., Any], estimator: Estimator, variables: Sequence[Variable], fit: Fit
    ) -> None:
        self.f, self.estimator, self.variables, self.fit = f, estimator, variables, fit
        self.names = [x.name for x in variables]
        self.popt = np.array([x.value for x in variables])
        self.pcov = self._covariance()
        self._unpacked: Tuple[Any, ...] = (self.popt, self.pcov)

    def _covariance(self) -> np.ndarray:
        try:
            return self.estimator.covariance(self.variables)
        except Error as error:
            if error.id != "slom.no-redundancy":
                raise
            warnings.warn(
                "there are as many parameters as data, so nothing is left to estimate the errors from, and pcov is "
                "infinite; pass sigma and absolute_sigma=True",
                stacklevel=4,
            )
            return np.full((len(self.variables), len(self.variables)), np.inf)

    @property
    def perr(self) -> np.ndarray:
        return np.sqrt(np.diag(self.pcov))

    def __iter__(self) -> Iterator[Any]:
        return iter(self._unpacked)

    def __len__(self) -> int:
        return len(self._unpacked)

    @overload
    def __getitem__(self, name: str) -> Variable: ...
    @overload
    def __getitem__(self, name: int) -> np.ndarray: ...
    @overload
    def __getitem__(self, name: slice) -> Tuple[Any, ...]: ...
    def __getitem__(self, name: Any) -> Any:
        """Returns the variable of a parameter: curve["a"].value, curve["a"].std. curve[0] is popt, curve[1] pcov."""
        if not isinstance(name, str):
            return self._unpacked[name]
        if name not in self.names:
            raise KeyError(f"there is no parameter {name!r}; the parameters are {', '.join(self.names)}")
        return self.variables[self.names.index(name)]

    def predict(self, x: ArrayLike) -> Any:
        """Returns the fitted curve at x: f(x, *popt)."""
        return self.f(np.asarray(x, float), *self.popt)

    def profile(self, name: str, probability: float = 0.95) -> Interval:
        """Returns the profile likelihood interval of a parameter."""
        return self.estimator.profile(self[name], probability=probability)

    def intervals(self, probability: float = 0.95) -> IntervalTable:
        """Returns the profile likelihood intervals of all parameters."""
        return self.estimator.intervals(probability)

    def plot(self, figure: Any = None, profiles: bool = False) -> Any:
        return self.fit.plot(figure, profiles)

    def __str__(self) -> str:
        return str(self.fit)

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return self.fit._repr_html_()


class NotFitted(Error, RuntimeError):
    """The fit of a curve has not converged."""


class BadCurve(Error, ValueError):
    """Data or options of a curve that cannot be used."""


F = TypeVar("F", bound=Callable[..., Any])


def _with_scipys_errors(function: F) -> F:
    """Makes errors of data ValueErrors, as in SciPy."""

    @functools.wraps(function)
    def wrapped(*arguments: Any, **options: Any) -> Any:
        try:
            return function(*arguments, **options)
        except (NotFitted, BadCurve):
            raise
        except Error as error:
            raise BadCurve(str(error), error.subject) from error

    return cast(F, wrapped)


@_with_scipys_errors
def curve_fit(
    f: Callable[..., Any],
    xdata: ArrayLike,
    ydata: ArrayLike,
    p0: Optional[ArrayLike] = None,
    sigma: Optional[ArrayLike] = None,
    absolute_sigma: bool = False,
    check_finite: bool = True,
    bounds: Any = (-np.inf, np.inf),
    *,
    names: Optional[Sequence[str]] = None,
    method: Optional[str] = None,
    jac: Any = None,
    full_output: bool = False,
    nan_policy: Optional[str] = None,
    maxfev: Optional[int] = None,
    loss: Optional[Loss] = None,
    **options: Any,
) -> CurveFit:
    """Fits f(x, a, b, ...) to data, with the arguments of scipy.optimize.curve_fit. The derivatives are exact.

    f               gets all of xdata, or one row if it computes each value from its own row alone
    xdata, ydata    M values; xdata may be k x M for functions of k variables
    p0              start values; without them 1, or the middle of the bounds
    sigma           standard deviations, M of them, or an M x M covariance
    absolute_sigma  False: only the ratios of sigma count, and the residuals give their scale
    bounds          (lower, upper): numbers, or one for each parameter; or a scipy.optimize.Bounds
    method, jac     have no effect: the derivatives are exact, and the estimator chooses the algorithm
    full_output     True: the result unpacks to popt, pcov, infodict, message, ier, with fvec, nfev and njev in infodict
    maxfev          the most iterations
    ftol, xtol, gtol  are decrease_tolerance, step_tolerance and gradient_tolerance of Estimator.optimize
    check_finite    has no effect: data that are not finite are refused in any case
    nan_policy      None or "raise": data that are not finite are refused. "omit": they are left out
    names           names of the parameters in reports; without them those of f's arguments
    loss            a robust loss, such as slom.Huber(1.345)
    options         those of Estimator.optimize

    Returns a CurveFit, which unpacks to popt, pcov. Raises an error that is a RuntimeError, too, if the fit does not
    converge, one that is a ValueError for data that cannot be used.

    >>> x = np.linspace(0, 2, 5)
    >>> y = np.array([2.52, 1.50, 0.92, 0.56, 0.33])
    >>> curve = slom.curve_fit(lambda x, a, b: a * np.exp(-b * x), x, y, p0=[1, 1])
    >>> popt, pcov = curve
    >>> print(popt.round(2), curve.perr.round(2))
    [2.51 1.01] [0.01 0.01]
    >>> print(round(curve["b"].value, 2))
    1.01
    """
    if nan_policy not in (None, "raise", "omit"):
        raise _error(f'nan_policy is {nan_policy!r}; pass None, "raise" or "omit"', "nan_policy")
    maxfev = options.pop("max_nfev", maxfev)
    if maxfev is not None:
        options["max_iterations"] = maxfev
    for scipys, own in _TOLERANCES.items():
        if scipys in options:
            options[own] = options.pop(scipys)
    unknown = sorted(set(options) - _OPTIONS)
    if unknown:
        raise _error(f"{unknown[0]} is no option; pass one of {', '.join(sorted(_OPTIONS | set(_TOLERANCES)))}, maxfev", unknown[0])
    p0 = None if p0 is None else np.atleast_1d(_numbers(p0, "p0"))
    given = _names(f, None if p0 is None else len(p0))
    names = list(names) if names is not None else given
    if len(names) != len(given) or len(set(names)) < len(names):
        raise _error(f"names are {', '.join(names)} for {len(given)} parameters; pass a name of its own for each", "names")
    lower, upper = _limits(bounds, names)
    if p0 is None:
        p0 = np.array([_start(a, b) for a, b in zip(lower, upper)])
    if len(p0) != len(names):
        raise _error(f"p0 has {len(p0)} start values for {len(names)} parameters; pass one for each parameter", "p0")
    x, y = np.asarray(xdata, float), np.asarray(ydata, float)
    rows = x.T if x.ndim > 1 else x
    if y.size == 0:
        raise _error("there are no data; pass at least as many values as there are parameters", "ydata")
    if y.ndim != 1 or len(rows) != len(y):
        if x.ndim == 2 and len(x) == len(y):
            raise _error(f"xdata has the shape {x.shape}; pass it as {x.shape[::-1]}, one row for each variable: xdata.T", "xdata")
        raise _error(
            f"xdata has {len(np.atleast_1d(rows))} values and ydata the shape {y.shape}; pass one value of ydata for each",
            "ydata",
        )
    if sigma is not None:
        sigma = np.asarray(sigma, float)
    if nan_policy == "omit":
        good = np.isfinite(y) & np.isfinite(rows).reshape(len(y), -1).all(axis=1)
        rows, y, x = rows[good], y[good], x[..., good]
        if sigma is not None and sigma.ndim:
            sigma = sigma[good] if sigma.ndim == 1 else sigma[np.ix_(good, good)]

    estimator = Estimator()
    if not absolute_sigma:
        estimator.sigma = "estimated"
    variables = []
    for name, value, a, b in zip(names, p0, lower, upper):
        variables.append(estimator.variable(float(value), name))
        if np.isfinite(a) or np.isfinite(b):
            variables[-1].bound(a, b)
    noise: Dict[str, Any] = {"loss": loss} if loss is not None else {}
    label = getattr(f, "__name__", "f")
    label = "f" if label == "<lambda>" else label
    joint = sigma is not None and sigma.ndim == 2
    if joint or not _measured_by_row(estimator, f, variables, x, rows, y, p0, {"sigma": sigma, "name": label, **noise}):
        if sigma is not None:
            noise["covariance" if joint else "sigma"] = sigma if joint or not sigma.ndim else sigma[None]
        try:
            estimator.measure(lambda *p: f(x, *p), *variables, measured=y[None], name=label, **noise)
        except Error as error:
            raise BadCurve(str(error), error.subject) from error
    fit = estimator.optimize(**options)
    if not fit.converged:
        raise NotFitted(f"[slom.not-fitted] the curve is not fitted: {_reason(fit)}", label)
    curve = CurveFit(f, estimator, variables, fit)
    if full_output:
        info = {"fvec": np.asarray(f(x, *curve.popt), float) - y, "nfev": fit.iterations, "njev": fit.iterations}
        curve._unpacked += (info, fit.message, 1)
    return curve


def _reason(fit):
    if fit.stop_reason == "rank deficient":
        fault = fit.message.partition("] ")[2].partition("; ")[0]
        return f"{fault}; drop a parameter, or add data that depend on it"
    return f"{fit.message}; pass better start values p0, or maxfev"


def _numbers(values, what):
    try:
        return np.asarray(values, float)
    except (TypeError, ValueError):
        raise _error(f"{what} is no array of numbers; pass one for each parameter", what) from None


def _limits(bounds, names):
    if hasattr(bounds, "lb"):
        bounds = bounds.lb, bounds.ub
    is_pair = isinstance(bounds, (tuple, list, np.ndarray)) and len(bounds) == 2
    limits = [_numbers(b, "bounds") for b in bounds] if is_pair else []
    if not is_pair or any(b.ndim > 1 or b.size not in (1, len(names)) for b in limits):
        raise _error(
            f"bounds are not two lists for {len(names)} parameters; pass (lower, upper), each a number or one for each "
            "parameter",
            "bounds",
        )
    lower, upper = (np.broadcast_to(b, len(names)) for b in limits)
    for name, a, b in zip(names, lower, upper):
        if not a < b:
            raise _error(
                f"the bounds of {name} are {a:g} and {b:g}; pass (lower bounds, upper bounds), the lower below the upper",
                "bounds",
            )
    return lower, upper


_TOLERANCES = {"ftol": "decrease_tolerance", "xtol": "step_tolerance", "gtol": "gradient_tolerance"}

_OPTIONS = {
    *("max_iterations", "max_seconds", "gradient_tolerance", "decrease_tolerance", "step_tolerance"),
    *("deviation_tolerance", "graduated_non_convexity", "most_parameters", "observer"),
}


def _measured_by_row(estimator, f, variables, x, rows, y, p0, options):
    """Adds a measurement for each row and returns True, if f computes each value from its own row and can be recorded."""
    if not _is_by_row(f, x, rows, p0):
        return False
    # A row may be a number where f makes an array like x.
    try:
        estimator.measure(lambda *p: f(p[-1], *p[:-1]), *variables, rows, measured=y, trace=True, **options)
    except Exception as error:
        if getattr(error, "id", "slom.traced").startswith("slom.traced"):
            return False
        raise BadCurve(str(error), error.subject) from error
    return True


def _names(f, count):
    if isinstance(f, np.vectorize):
        f = f.pyfunc
    parameters = list(inspect.signature(f).parameters.values())
    any_number = any(p.kind is p.VAR_POSITIONAL for p in parameters)
    parameters = parameters[1:]
    if any_number:
        if count is None:
            raise _error("f takes any number of parameters; pass p0, one start value for each", "p0")
        return [f"p{i}" for i in range(count)]
    named = [p for p in parameters if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    if count is not None:
        named = named[: max(count, sum(p.default is p.empty for p in named))]
    return [p.name for p in named]


def _start(lower, upper):
    if np.isfinite(lower) and np.isfinite(upper):
        return (lower + upper) / 2
    if np.isfinite(lower):
        return lower + 1
    return upper - 1 if np.isfinite(upper) else 1.0


def _is_by_row(f, x, rows, p):
    """Whether f computes each value from its own row."""
    with np.errstate(all="ignore"):
        whole = np.asarray(f(x, *p), float)
        if whole.shape != (len(rows),):
            return whole.ndim == 0 and len(rows) > 0
        for i in {0, len(rows) // 2, len(rows) - 1}:
            try:
                one = np.asarray(f(rows[i], *p), float)
            except Exception:
                return False
            if one.shape != () or not np.isclose(one, whole[i], rtol=1e-9, atol=0, equal_nan=True):
                return False
    return True


def _error(sentence, subject):
    return BadCurve(f"[slom.bad-argument] {sentence}", subject)
