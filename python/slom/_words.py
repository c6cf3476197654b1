"""Messages of the library in the words of this package: they name functions of C++."""

import re
from typing import Any, List

_VARIABLE, _MEASUREMENT = r"(?:the )?(?:Any)?VarID(?:<.*?>+(?= ))?", r"(?:the )?(?:Any)?MeasID(?:<.*?>+(?= ))?"

# Pattern, replacement. Applied in this order.
_WORDS: List[Any] = [
    (f"{_VARIABLE} refers to a variable that has been removed; keep the VarID that insertRV returned last",
     "the variable has been removed from its estimator; use one that est.variable returned"),
    (f"{_MEASUREMENT} refers to a measurement that has been removed; keep the MeasID that insertMeasurement returned last",
     "the measurement has been removed from its estimator; use one that est.measure returned"),
    (f"{_VARIABLE} refers to a variable that was not in the problem when the marginals were computed; call marginals"
     r"\(\) again, of the estimator that holds it",
     "the variable has been removed from its estimator; use one that est.variable returned"),
    (r"slom::checkDerivatives\(est\)", "est.check_derivatives()"),
    (r"pass larger steps, as in slom::numeric\(f, slom::differences\(1e-2\)\)", "pass its derivatives as jacobian="),
    (r"is not registered with the archive; name it by archive\.measurement, with the function's type and those of its "
     r"arguments", "is that of a function that could not be recorded; write it so that measure can record it"),
    (f"{_VARIABLE} belongs to another estimator; use it only with the estimator whose insertRV returned it",
     "the variable belongs to another estimator; use it with its own, or est.own(x) for that of a clone"),
    (f"{_MEASUREMENT} belongs to another estimator; use it only with the estimator whose insertMeasurement returned it",
     "the measurement belongs to another estimator; use it with its own"),
    (r"slom::group\((?:key)?\) to insertMeasurement|slom::group to insertMeasurement", "group= to est.measure"),
    (r'slom::group once, or once for each of several names: slom::group\("image", 17\)',
     'one key of a group, or a dict of several: group={"image": keys}'),
    (r"list the variables in slom::ClusterBy::variables", "pass the variables as by="),
    (r"slom::ClusterBy::variables", "variables"),
    (r', as in \{\.by = \{"(.*?)"\}\}', r', as in by="\1"'),
    (r"setSigma\(slom::Sigma::(\w+)\)|Sigma::(\w+)", lambda m: f'est.sigma = "{m[1] or m[2]}"'),
    (r"setFreeGauge\(slom::FreeGauge::(\w+)\)", r'est.free_gauge = "\1"'),
    (r"fix it with fix\(id\)", "fix it with x.fix()"),
    (r'with fix\(id\) or a part of it with fix\(id, "path"\)', 'with x.fix() or a part of it with x.fix("path")'),
    (r"of LevenbergMarquardt is", 'of "lm" is'),
    (r"\bLevenbergMarquardt\b", 'est.use_algorithm("lm")'),
    (r", or BlockQR, which needs [^;]*?(?=;|$)", ""),
    (r"slom::clustered\(est\)", "est.clustered()"),
    (r"slom::varianceComponents\(est\)", "est.variance_components()"),
    (r"pass the VarID of", "pass"),
    (r"slom::diagnose\(est\)", "est.diagnose()"),
    (r"slom::outliers\(est\)", "est.outliers()"),
    (r"\b(?:\w+Options|Options)::kByTheSize", "None"),
    (r"\b(?:Cluster|Variance|Outlier)?Options::(\w+)", r"\1="),
    (r" of OutlierOptions", ""),
    (r"insertMeasurement", "est.measure"),
    (r"insertRV", "est.variable"),
    (r"summary\.converged", "fit.converged"),
    (r"slom::", "slom."),
]
_WORDS = [(re.compile(pattern), replacement) for pattern, replacement in _WORDS]


def in_python(text):
    """Returns a message of the library as this package says it."""
    for pattern, replacement in _WORDS:
        text = pattern.sub(replacement, text)
    return text
