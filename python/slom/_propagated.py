from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Propagated:
    """A quantity computed from variables."""

    value: Any
    covariance: np.ndarray  #: in the tangent space of the value

    def __repr__(self) -> str:
        if isinstance(self.value, float):
            return f"{self.value:.8g} ± {self.std:.3g}"
        return f"{self.value} ± {self.std}"

    @property
    def std(self) -> Any:
        """Standard deviations: a number for a number, an array of the shape of an array."""
        deviations = np.sqrt(np.diag(self.covariance))
        if isinstance(self.value, float):
            return float(deviations[0])
        return deviations.reshape(self.value.shape) if isinstance(self.value, np.ndarray) else deviations
