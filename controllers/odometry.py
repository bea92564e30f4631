"""Velocity from what a robot has on board: accelerometer, heading and wheel speeds.

The wheels tell the speed as long as they roll. Accelerating, braking and on slippery ground they slip, and a slip limit
that took them at their word would follow a spinning wheel. So the velocity is carried on by the measured acceleration
and corrected, forward by the wheels, the less the further they are from it, and sideways to none, slowly, since on
slippery ground a robot slides for seconds:

    v- = v + dv,    v+ = v- + a d e_x - b (v- . e_y) e_y,    d = R mean(wheel speeds) - v- . e_x,
    a = (1 - e^(-k T)) / (1 + (d / s)^2),    b = 1 - e^(-q T).
"""

import math
from dataclasses import dataclass

from dynabot_mj.controllers.arrays import Array
from dynabot_mj.controllers.axes import Axes, dot


@dataclass(frozen=True, kw_only=True)
class Odometry:
    """Gains of the filter."""

    correction: float = 1.0  # k, forward, by wheels that roll [1/s]
    slip: float = 0.15  # s, difference from which the wheels are believed less than half [m/s]
    settling: float = 0.1  # q, sideways [1/s]


# Ideal sensors have no bias to hold against. Real ones have: forward the filter bears accelerations that are wrong by
# up to k s / 2, beyond which it would take the wheels for slipping.
REAL_SENSORS = Odometry(correction=4.0, slip=0.3, settling=1.0)


def velocity(
    velocity_w: Array,
    increment_w: Array,
    axes: Axes,
    wheel_speed: Array,
    *,
    wheel_radius: float,
    period: float,
    gains: Odometry,
) -> Array:
    """Returns the velocity after a period.

    Args:
        velocity_w: v before, (2, ...) [m/s].
        increment_w: dv, the measured acceleration integrated over the period, (2, ...) [m/s].
        axes: At the period's end.
        wheel_speed: Of the four wheels, (..., 4) [rad/s].
        wheel_radius: R [m].
        period: T [s].
        gains: Of this filter.

    Returns:
        (2, ...) [m/s].
    """
    forward_w, left_w = axes
    predicted_w = velocity_w + increment_w
    rolled = wheel_radius / 4.0 * wheel_speed.sum(axis=-1)  # NumPy's own mean takes twice as long
    difference = rolled - dot(predicted_w, forward_w)
    belief = (1.0 - math.exp(-gains.correction * period)) / (1.0 + (difference / gains.slip) ** 2)
    sideways = 1.0 - math.exp(-gains.settling * period)
    return predicted_w + (belief * difference) * forward_w - (sideways * dot(predicted_w, left_w)) * left_w
