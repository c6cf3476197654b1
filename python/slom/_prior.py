import numpy as np

from ._error import Error


def prior(estimator, variable, value, sigma, covariance, information, path, loss, name):
    options = {} if loss is None else {"loss": loss}
    names = [name[len(variable.name) :].lstrip(".") for name in variable.components]
    if path and not any(name == path or name.startswith(path + ".") for name in names):
        raise Error(
            f'[slom.no-component] variable {variable.name} has no component "{path}"; pass one of {", ".join(names)}',
            variable.name,
        )
    measured = [value] if not isinstance(value, (float, int)) else np.array([value], float)
    if isinstance(value, np.ndarray):
        measured = value[None]
    return estimator.measure(
        lambda x: _component(x, path),
        variable,
        measured=measured,
        sigma=sigma,
        covariance=covariance,
        information=information,
        name=name,
        **options,
    )


def _component(x, path):
    for name in path.split(".") if path else ():
        if isinstance(x, np.ndarray):
            x = x["xyz".index(name) if name in ("x", "y", "z") else int(name)]
        else:
            x = getattr(x, name)
    return x
