import numpy as np

from . import _slom


def minus(prediction, datum):
    """Returns prediction [-] datum."""
    if hasattr(type(datum), "__slom_fields__"):
        return [minus(getattr(prediction, name), getattr(datum, name)) for name in type(datum).__slom_fields__]
    if hasattr(datum, "boxminus"):
        return prediction.boxminus(datum)
    if isinstance(prediction, (list, tuple)):
        prediction = np.array(prediction)
    if np.shape(prediction) != np.shape(datum):
        _slom._raise(
            "slom.wrong-shape",
            f"the measurement function predicts an array of shape {np.shape(prediction)}, each row of `measured` has "
            f"the shape {np.shape(datum)}; return what is measured, in the same shape",
            "measured",
        )
    return prediction - datum
