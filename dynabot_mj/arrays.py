"""Names of array types. Shapes stand beside each field and in each docstring: B trials, n robots."""

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
