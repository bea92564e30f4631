"""The protocol of robots that are pushed by force commands, and their true state."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from dynabot_mj.common.arrays import Array, BoolArray

# Between the states that a plant passes through: collisions are looked for this often, by both plants alike [s].
LONGEST_SUBSTEP = 0.010


@dataclass(frozen=True, kw_only=True)
class FleetState:
    """True planar state of all robots of all trials at one instant.

    Attributes:
        time: [s].
        position_w: (B, n, 2) of the robots' centres [m].
        velocity_w: (B, n, 2) of the centres [m/s].
        heading: (B, n) from the world's x axis, not wrapped [rad].
        yaw_rate: (B, n) [rad/s].
        velocity_increment_b: (B, n, 2) integral since the start of what ideal accelerometers feel ahead and to the
            left, gravity in a tilted robot included [m/s]: differences between two times are velocity increments, as
            inertial units give them.
        pose: (B, n, 11) MuJoCo's coordinates: the free joint's, then the wheels' angles [rad]; None: point masses.
        wheel_speed: (B, n, 4) in the order of `scene.WHEELS` [rad/s]; None: point masses.

    Example:
        >>> state = dy.ParticlePlant(12.0, np.zeros((10, 3, 2)), np.zeros((10, 3))).state
        >>> state.time, state.velocity_w.shape, state.pose
        (0.0, (10, 3, 2), None)
    """

    time: float
    position_w: Array
    velocity_w: Array
    heading: Array
    yaw_rate: Array
    velocity_increment_b: Array
    pose: Array | None = None
    wheel_speed: Array | None = None


@dataclass(frozen=True, kw_only=True)
class NavigationError:
    """What the signals that local laws run on are off by, at the beginning of a gap and held through it."""

    heading: Array  # (B, n) of the believed heading; it grows by the yaw rate's error [rad]
    yaw_rate: Array  # (B, n) of the gyro, the believed bias taken off [rad/s]
    # (B, n, 2) of the accelerometer, the believed bias taken off [m/s^2]; None: it tells the true acceleration
    acceleration_b: Array | None


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

    def step(self, force_w: Array, gap: float, error: NavigationError | None = None) -> Sequence[FleetState]:
        """Advances all robots under a held force command.

        Args:
            force_w: Total command on each robot, (B, n, 2) [N].
            gap: Time until the next event [s].
            error: Of what local laws run on; None: ideal sensors and a known heading.

        Returns:
            The states passed through, at most `LONGEST_SUBSTEP` apart, the last one at the end of the gap.
        """
        ...


@runtime_checkable
class WheeledPlant(Plant, Protocol):
    """Vehicles: robots with hulls and wheels, whose local laws make them imitate point masses."""

    @property
    def hull_contact(self) -> BoolArray:
        """Trials in which a hull has touched anything so far, (B,)."""
        ...

    @property
    def wheel_slip(self) -> Array:
        """Largest speed of a tyre along its wheel's plane against the ground so far, (B,) [m/s]."""
        ...

    @property
    def odometry_w(self) -> Array:
        """Velocity by wheels and accelerometer, (B, n, 2) [m/s]."""
        ...

    @property
    def reference_w(self) -> Array:
        """Velocity of the point mass that the robots imitate, (B, n, 2) [m/s]."""
        ...
