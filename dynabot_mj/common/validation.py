"""Types of the configuration's values, as pydantic checks them; their units."""

from typing import Annotated

from pydantic import ConfigDict, Field

LARGEST = 1e6  # of any quantity; squares of far larger ones overflow
Positive = Annotated[float, Field(gt=0.0, le=LARGEST, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, le=LARGEST, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
# Of the keys of a study, and of the tether experiment, that have one and whose name says what they are.
UNITS = {
    **dict.fromkeys(("duration", "period", "sample_period", "control_period", "tick", "correlation_time"), "s"),
    **dict.fromkeys(("estimation_time", "latency", "alignment", "fix_patience", "bearing_patience"), "s"),
    **dict.fromkeys(("spacing", "width", "leader_range", "neighbour_range", "closest", "distance"), "m"),
    **dict.fromkeys(("collision_distance", "uncertainty"), "m"),
    **dict.fromkeys(("mass", "payload"), "kg"),
    **dict.fromkeys(("alpha_h", "alpha_d"), "N m"),
    "force_limit": "N",
    "dissipation": "N s/m",
    "message_bytes": "bytes",
}
STRICT = ConfigDict(extra="forbid", strict=True)
