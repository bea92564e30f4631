"""What a control law is: a function from what robots know to the total force on each of them.

The study's own law is the potential field of Eq. 8 (`dynabot_mj.controllers.potential_field`); any other function of
this form can take its place, in the study and in the environment alike.
"""

from collections.abc import Callable
from dataclasses import dataclass

from dynabot_mj.controllers.arrays import Array, BoolArray


@dataclass(frozen=True, kw_only=True)
class Information:
    """What n robots know when they act; leading axes, where there are any, are of trials."""

    time: float  # [s]
    position_w: Array  # (..., n, 2) of each robot, as it believes [m]
    velocity_w: Array  # (..., n, 2) of each robot, from the dissipation's source [m/s]
    leader_w: Array  # (2,) known to all, exactly [m]
    heard_position_w: Array  # (..., n, n, 2) newest position that receiver i has of sender j [m]; where not known, void
    heard_known: BoolArray  # (..., n, n) whether i has heard of j; never of itself
    heard_age: Array  # (..., n, n) time since that position was sampled [s]; inf where not known


Law = Callable[[Information], Array]  # total force on each robot, (..., n, 2) [N]
