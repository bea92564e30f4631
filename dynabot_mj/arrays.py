"""Names of array types, and what converters do. Shapes stand in each docstring: B trials, n robots."""

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]


def measured(value: Array, resolution: float) -> Array:
    """Returns what a converter of a resolution reads; 0: the value itself."""
    return resolution * np.round(value / resolution) if resolution > 0.0 else value
