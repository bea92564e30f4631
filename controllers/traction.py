"""Forward speed and yaw rate -> wheel speeds and torque feed-forward, with limits of slip and current.

Proportional feedback about the kinematics of a vehicle whose wheels all skid sideways,

    wheel speed = (v -+ yaw_rate T_eff / 2) / R,        T_eff = T + L^2 / T,

plus the torque that the motion needs: m_eff a R / 4 to accelerate, and the scrub torque of four tyres dragged sideways
while turning, together within the motor's current limit. The motor's own speed loop, torque = K (commanded - actual)
+ feed-forward, adds what is left, so an integral would have little to remove; it made the robots overshoot. Yaw-rate
feedback is not optional: without it the vehicle spins out above 4 m/s.

On slippery ground the wheel would run up to commanded + feed-forward / K, where its torque vanishes. That speed is what
the slip limit keeps near the ground's.
"""

from dataclasses import dataclass

import numpy as np

from dynabot_mj.controllers.arrays import Array
from dynabot_mj.controllers.axes import components_last
from dynabot_mj.controllers.steering import Motion
from dynabot_mj.controllers.vehicle import Vehicle

# Front left, front right, rear left, rear right: how a yaw rate to the left moves each wheel.
SIDES = np.array([-1.0, 1.0, -1.0, 1.0])


@dataclass(frozen=True, kw_only=True)
class Traction:
    """Gains of the law."""

    speed_gain: float  # of the forward-speed error
    yaw_gain: float  # of the yaw-rate error
    scrub_torque: float  # needed by a wheel to turn the vehicle on the spot [Nm]
    scrub_rate: float  # yaw rate at which three quarters of it are needed [rad/s]
    slip_limit: float  # of a wheel's speed without load against the ground, at rest [m/s]
    slip_share: float  # its increase with the ground speed


def drive(
    motion: Motion,
    speed: Array,
    yaw_rate: Array,
    *,
    vehicle: Vehicle,
    gains: Traction,
) -> tuple[Array, Array]:
    """Returns the motors' commands.

    Args:
        motion: What the steering law asks for; a motion of zeros holds the robot still.
        speed: Measured forward speed, (...) [m/s].
        yaw_rate: Measured, (...) [rad/s].
        vehicle: The vehicle's parameters.
        gains: Of this law.

    Returns:
        Wheel speeds, (..., 4) [rad/s], and torque feed-forward, (..., 4) [Nm], in the order of `SIDES`.
    """
    half_track = vehicle.turning_track / 2.0
    # Front and rear wheels are told the same, so there are two numbers per robot: (2, ...), left and right.
    ground = _sides(speed, half_track * yaw_rate)
    wanted = _sides(
        motion.speed + gains.speed_gain * (motion.speed - speed),
        half_track * (motion.yaw_rate + gains.yaw_gain * (motion.yaw_rate - yaw_rate)),
    )
    push = vehicle.effective_mass * motion.acceleration * (vehicle.wheel_radius / 4.0)
    scrub = gains.scrub_torque * np.tanh(motion.yaw_rate / gains.scrub_rate)
    torque = _sides(push, scrub).clip(-vehicle.torque_limit, vehicle.torque_limit)
    ahead = vehicle.wheel_radius * torque / vehicle.servo_gain
    slip = gains.slip_limit + gains.slip_share * np.abs(ground)
    rim_speed = ground + (wanted + ahead - ground).clip(-slip, slip) - ahead
    return _at_wheels(rim_speed / vehicle.wheel_radius), _at_wheels(torque)


def _sides(straight: Array, turn: Array) -> Array:
    """Returns what moves the robot straight on and turns it to the left, for its left and right side, (2, ...)."""
    return np.array((straight - turn, straight + turn))


def _at_wheels(sides: Array) -> Array:
    """Returns what each wheel is told in the order of `SIDES`, (..., 4)."""
    return components_last(np.concatenate((sides, sides)))
