"""Types of the configuration's values, as pydantic checks them."""

from typing import Annotated

from pydantic import ConfigDict, Field

LARGEST = 1e6  # of any quantity; squares of far larger ones overflow
Positive = Annotated[float, Field(gt=0.0, le=LARGEST, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, le=LARGEST, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
STRICT = ConfigDict(extra="forbid", strict=True)
