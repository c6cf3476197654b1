import numpy as np

from ._array import array
from ._error import Error


def minus(prediction, datum):
    """Returns prediction [-] datum."""
    if hasattr(type(datum), "__slom_fields__"):
        return [minus(getattr(prediction, name), getattr(datum, name)) for name in type(datum).__slom_fields__]
    if prediction is None or isinstance(prediction, (str, dict)):
        raise Error(
            f"[slom.bad-residual] the measurement function returned a value of type {type(prediction).__name__}; return "
            "what is measured",
            "measured",
        )
    if hasattr(datum, "boxminus"):
        return prediction.boxminus(datum)
    if hasattr(prediction, "boxminus"):
        kind = type(prediction).__name__.replace("Recorded", "")
        raise Error(
            f"[slom.wrong-shape] the measurement function predicts values of type {kind}, each row of `measured` has the "
            f"shape {np.shape(datum)}; pass a list of {kind}, or slom.Rows(array, like=slom.{kind})",
            "measured",
        )
    if isinstance(prediction, (list, tuple)):
        prediction = array(prediction)
    if np.shape(prediction) != np.shape(datum):
        raise Error(
            f"[slom.wrong-shape] the measurement function predicts an array of shape {np.shape(prediction)}, each row of "
            f"`measured` has the shape {np.shape(datum)}; return what is measured, in the same shape",
            "measured",
        )
    return prediction - datum
