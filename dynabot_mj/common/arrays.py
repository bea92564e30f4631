"""Names of types that are everywhere, and what converters do. Shapes stand in each docstring: B trials, n robots."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
Progress = Callable[[float], None]  # told the share of the work that is done


def rms(values: Array, axis: int | tuple[int, ...] | None = None) -> Array:
    """Returns the root mean square over some axes; None: over all."""
    return np.sqrt((values**2).mean(axis=axis))


def measured(value: Array, resolution: float) -> Array:
    """Returns what a converter of a resolution reads; 0: the value itself."""
    return resolution * np.round(value / resolution) if resolution > 0.0 else value
