"""The local laws of rigid robots: from force commands and what is sensed on board to motor commands.

They run on what the robot has on board: yaw rate from the gyro, forward speed from wheel speeds and accelerometer
(`dynabot_mj.controllers.odometry`), and its heading. Those are ideal, or as wrong as the perception says. Or the laws
run on the truth, to tell one's errors from the other's.
"""

from dataclasses import dataclass

import numpy as np

from dynabot_mj.common.arrays import Array, measured
from dynabot_mj.common.frames import to_world
from dynabot_mj.controllers import axes, odometry, steering, traction
from dynabot_mj.controllers.axes import Axes, components_first, components_last, dot
from dynabot_mj.controllers.odometry import Odometry
from dynabot_mj.controllers.steering import HandPoint, Heading
from dynabot_mj.controllers.traction import Traction
from dynabot_mj.controllers.vehicle import Vehicle
from dynabot_mj.plants.plant import FleetState, NavigationError

_ODOMETRY = Odometry()


@dataclass(frozen=True, kw_only=True)
class LocalLaws:
    """How each robot turns its force command into motor commands."""

    steering: HandPoint | Heading
    traction: Traction
    odometry: Odometry = _ODOMETRY
    on_board: bool = True  # False: they know the true speed, heading and yaw rate
    wheel_resolution: float = 0.0  # of the wheel speeds, where sensors have errors [rad/s]


class Drivers:
    """The local laws at work, with what they remember of each robot."""

    def __init__(self, laws: LocalLaws, vehicle: Vehicle, state: FleetState) -> None:
        """Starts with robots at rest.

        Args:
            laws: Of each robot.
            vehicle: The robots' parameters.
            state: At the start.
        """
        self._laws, self._vehicle = laws, vehicle
        self._reference = steering.rest(state.heading.shape)
        self._velocity_w = np.zeros((2, *state.heading.shape))
        self._sensed = state
        self._past_error: NavigationError | None = None

    @property
    def odometry_w(self) -> Array:
        """Velocity by wheels and accelerometer, (B, n, 2) [m/s]."""
        return components_last(self._velocity_w)

    @property
    def reference_w(self) -> Array:
        """Velocity of the point mass that the steering law imitates, (B, n, 2) [m/s]."""
        return components_last(self._reference.velocity_w)

    def drive(
        self,
        force_w: Array,
        state: FleetState,
        spin: Array,
        wheel_speed: Array,
        period: float,
        error: NavigationError | None = None,
    ) -> tuple[Array, Array]:
        """Returns the motors' commands for the period that begins.

        Args:
            force_w: Total command, (B, n, 2) [N].
            state: The true state now.
            spin: What an ideal gyro measures, (B, n) [rad/s].
            wheel_speed: Of the four wheels, (B, n, 4) [rad/s].
            period: Its length [s].
            error: Of what the laws run on; None: ideal sensors and a known heading.

        Returns:
            Wheel speeds, (B, n, 4) [rad/s], and torque feed-forward, (B, n, 4) [Nm].
        """
        laws = self._laws
        facing, speed, yaw_rate = self._sense(state, spin, wheel_speed, error)
        if not laws.on_board:
            facing, yaw_rate = axes.of_heading(state.heading), state.yaw_rate
            speed = dot(components_first(state.velocity_w), facing.forward_w)
        self._reference, motion = steering.steer(
            self._reference,
            components_first(force_w),
            facing,
            speed,
            mass=self._vehicle.mass,
            period=period,
            gains=laws.steering,
        )
        self._past_error = error
        return traction.drive(motion, speed, yaw_rate, vehicle=self._vehicle, gains=laws.traction)

    def _sense(
        self, state: FleetState, spin: Array, wheel_speed: Array, error: NavigationError | None
    ) -> tuple[Axes, Array, Array]:
        """Returns axes, forward speed and yaw rate by all that is on board; speeds are (B, n) [m/s], [rad/s]."""
        heading = state.heading if error is None else state.heading + error.heading
        facing = axes.of_heading(heading)
        if state.time > self._sensed.time:
            self._velocity_w = odometry.velocity(
                self._velocity_w,
                components_first(self._increment_w(heading, state, spin)),
                facing,
                wheel_speed if error is None else measured(wheel_speed, self._laws.wheel_resolution),
                wheel_radius=self._vehicle.wheel_radius,
                period=state.time - self._sensed.time,
                gains=self._laws.odometry,
            )
            self._sensed = state
        speed = dot(self._velocity_w, facing.forward_w)
        return facing, speed, spin if error is None else spin + error.yaw_rate

    def _increment_w(self, heading: Array, state: FleetState, spin: Array) -> Array:
        """Returns by how much the velocity has changed since it was last sensed, by accelerometer, (B, n, 2) [m/s]."""
        before = self._sensed
        # The errors that held while the increments were gathered, not those of the period that begins.
        past = self._past_error
        if past is None or past.acceleration_b is None:
            return state.velocity_w - before.velocity_w
        period = state.time - before.time
        felt_b = state.velocity_increment_b - before.velocity_increment_b + period * past.acceleration_b
        return to_world(felt_b, heading - 0.5 * period * (spin + past.yaw_rate))
