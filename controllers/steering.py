"""Force command -> point-mass reference -> forward speed and yaw rate: the hand point.

A skid-steer robot cannot accelerate sideways, a point mass can. So the law integrates what the point mass would do and
keeps it near what the robot does (anti-windup), measured as its forward motion v e_x, e_x being its forward axis:

    d v_ref / dt = F / m + k (v e_x - v_ref).

F is the total command, dissipation on the robot's own velocity included; the law adds none of its own. With k = c / m
it would be the point mass exactly, at the robot's place: the two terms in v then cancel. A hand point, a distance l
ahead of the centre, is to move with v_ref: its velocity is v along e_x and l * yaw_rate along the left axis e_y, so
that

    v = v_ref . e_x,        yaw_rate = v_ref . e_y / l + (d v_ref / dt . e_y) v / (v^2 + v0^2).

There is no singularity at rest and no choice between driving forward and reversing: the robot turns into v_ref by
itself. The second term of the yaw rate is the rate at which the direction of v_ref itself turns, regularised at low
speed by v0. Without it the heading lags by l / v seconds, enough to make the robots swing about the floor of the
well.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class HandPoint:
    """Gains of the law, chosen by hand."""

    offset: float = 0.35  # l, of the hand point ahead of the centre [m]
    hold: float = 1.5  # k, at which the reference is pulled to the robot's motion [1/s]
    turning_speed: float = 0.8  # v0, below which the turning of the reference counts less [m/s]
    yaw_rate_limit: float = 3.0  # [rad/s]
    deadband: float = 0.01  # reference speed below which the robot is told to rest [m/s]


@dataclass(frozen=True, kw_only=True)
class Motion:
    """What the traction law is asked for."""

    speed: Array  # (...) forward [m/s]
    acceleration: Array  # (...) forward [m/s^2]
    yaw_rate: Array  # (...) [rad/s]


def steer(
    reference_w: Array,
    force_w: Array,
    heading: Array,
    speed: Array,
    *,
    mass: float,
    period: float,
    gains: HandPoint,
) -> tuple[Array, Motion]:
    """Advances the point-mass reference, exactly for a held force and motion, and returns the motion that follows it.

    Args:
        reference_w: v_ref before, (..., 2) [m/s].
        force_w: Total command, (..., 2) [N].
        heading: Measured, (...) [rad].
        speed: Measured forward speed v, (...) [m/s].
        mass: Of the point mass that is imitated [kg].
        period: Of this law [s].
        gains: Of this law.

    Returns:
        v_ref after, (..., 2) [m/s], and the motion to ask of the traction law.
    """
    forward_w = np.stack([np.cos(heading), np.sin(heading)], axis=-1)
    left_w = np.stack([-forward_w[..., 1], forward_w[..., 0]], axis=-1)
    # v_ref tends to this velocity, at which the pull balances the force.
    target_w = speed[..., None] * forward_w + force_w / (mass * gains.hold)
    reference_w = target_w + math.exp(-gains.hold * period) * (reference_w - target_w)
    acceleration_w = gains.hold * (target_w - reference_w)
    along, across = _dot(reference_w, forward_w), _dot(reference_w, left_w)
    turning = _dot(acceleration_w, left_w) * along / (along * along + gains.turning_speed**2)
    yaw_rate = np.clip(across / gains.offset + turning, -gains.yaw_rate_limit, gains.yaw_rate_limit)
    moving = along * along + across * across >= gains.deadband**2
    return reference_w, Motion(
        speed=np.where(moving, along, 0.0),
        acceleration=np.where(moving, _dot(force_w, forward_w) / mass, 0.0),
        yaw_rate=np.where(moving, yaw_rate, 0.0),
    )


def _dot(a: Array, b: Array) -> Array:
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1]
