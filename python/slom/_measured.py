import numpy as np

from ._array import array
from ._error import Error


def minus(prediction, datum):
    """Returns prediction [-] datum."""
    if hasattr(type(datum), "__slom_fields__"):
        return [minus(getattr(prediction, name), getattr(datum, name)) for name in type(datum).__slom_fields__]
    if hasattr(datum, "boxminus"):
        return prediction.boxminus(datum)
    if isinstance(prediction, (list, tuple)):
        prediction = array(prediction)
    if np.shape(prediction) != np.shape(datum):
        raise Error(
            f"[slom.wrong-shape] the measurement function predicts an array of shape {np.shape(prediction)}, each row of "
            f"`measured` has the shape {np.shape(datum)}; return what is measured, in the same shape",
            "measured",
        )
    return prediction - datum
