"""Options of the rigid robots: which they are, on what ground, by which local laws."""

from typing import Annotated, Literal, get_args

from pydantic import Field
from pydantic.dataclasses import dataclass

from dynabot_mj.common.validation import STRICT, NotNegative
from dynabot_mj.plants import scene

SteeringName = Literal["hand-point", "heading"]
SensingName = Literal["on-board", "truth"]
STEERINGS: tuple[SteeringName, ...] = get_args(SteeringName)
SENSINGS: tuple[SensingName, ...] = get_args(SensingName)
Friction = Annotated[float, Field(ge=0.05, le=1.5)]


@dataclass(frozen=True, kw_only=True, config=STRICT)
class VehicleOptions:
    """The rigid robots, the ground, and the local laws that make them follow their force commands."""

    model: str = scene.BUILT_IN  # or the path of another robot's MJCF
    # Coefficient of tyre and ground; two values: drawn uniformly between them, one per trial; model: the MJCF's
    friction: Friction | tuple[Friction, Friction] | Literal["model"] = "model"
    slope: Annotated[float, Field(ge=-0.5, le=0.5)] = 0.0  # rise of the ground per metre toward +x
    payload: NotNegative = 0.0  # mass on each robot's top [kg]
    steering: SteeringName = "hand-point"
    sensing: SensingName = "on-board"  # truth: the local laws know the true speed and yaw rate
    gains: str = "tuned"  # of the local laws: a set of controllers/gains, or the path of a gain file
