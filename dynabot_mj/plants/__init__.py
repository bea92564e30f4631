"""The two kinds of robots behind one protocol: `particle` (point masses) and `rigid_body` (MuJoCo)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from dynabot_mj.arrays import Array, BoolArray

# Collisions are looked for at least this often, by both plants alike [s].
LOOK_PERIOD = 0.010


@dataclass(frozen=True, kw_only=True)
class FleetState:
    """True planar state of all robots of all trials at one instant."""

    time: float  # [s]
    position_w: Array  # (B, n, 2) of the robots' centres [m]
    velocity_w: Array  # (B, n, 2) of the centres [m/s]
    heading: Array  # (B, n) from the world's x axis, not wrapped [rad]
    yaw_rate: Array  # (B, n) [rad/s]


class Plant(Protocol):
    """Robots that are pushed by force commands."""

    @property
    def state(self) -> FleetState:
        """The state now."""
        ...

    @property
    def diverged(self) -> BoolArray:
        """Trials whose simulation broke down at some time and no longer means anything, (B,)."""
        ...

    @property
    def hull_contact(self) -> Array | BoolArray:
        """Trials in which a hull has touched anything so far, (B,); NaN where there are no hulls."""
        ...

    @property
    def wheel_slip(self) -> Array:
        """Largest speed of a tyre along its wheel's plane against the ground so far, (B,) [m/s]; NaN without wheels."""
        ...

    def step(self, force_w: Array, gap: float) -> Sequence[FleetState]:
        """Advances all robots under a held force command.

        Args:
            force_w: Total command on each robot, (B, n, 2) [N].
            gap: Time until the next event [s].

        Returns:
            The states passed through, at most `LOOK_PERIOD` apart, the last one at the end of the gap.
        """
        ...
