"""Force command -> point-mass reference -> forward speed and yaw rate, by one of two laws.

A skid-steer robot cannot accelerate sideways, a point mass can. So both laws integrate what the point mass would do and
keep it near what the robot does (anti-windup), measured as its forward motion v e_x, e_x being its forward axis:

    d v_ref / dt = F / m + k (v e_x - v_ref).

F is the total command, dissipation on the robot's own velocity included; the law adds none of its own. With k = c / m
it would be the point mass exactly, at the robot's place: the two terms in v then cancel. The way by which the robot has
fallen behind is remembered, forgotten slowly and bounded, and the velocity to realise makes up for it:

    d lag / dt = v_ref - v e_x - f lag,   |lag| <= farthest,        u = v_ref + q lag + t d v_ref / dt.

The preview t makes up for the periods and the wheels' inertia that lie between a command and the motion.

hand_point  A point a distance l ahead of the centre is to move with u: its velocity is v along e_x and l * yaw_rate
            along the left axis e_y, so that

                v = u . e_x,        yaw_rate = u . e_y / l + (d v_ref / dt . e_y) (u . e_x) / ((u . e_x)^2 + v0^2).

            There is no singularity at rest and no choice between driving forward and reversing: the robot turns into u
            by itself. The second term is the rate at which the direction of v_ref turns, regularised at low speed by
            v0. Without it the heading lags by l / v seconds, enough to swing about the floor of the well.
heading     Turn the nearer end of the robot into u, and drive as far as it points there:

                v = u . e_x,        yaw_rate = g angle,   the angle from e_x, or from -e_x where u points back, to u.

At rest, a force to the front or the back moves the robot at once, one to the side turns it first. A force exactly to
the back leaves the hand point balanced, and the robot reverses; any sideways part turns it round on its way. With the
other law it reverses, whatever is small beside it. The yaw rate is limited. Below the deadband the robot is told to
rest.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dynabot_mj.controllers.arrays import Array
from dynabot_mj.controllers.axes import Axes, dot


@dataclass(frozen=True, kw_only=True)
class PointMass:
    """Gains of the reference, which both laws share."""

    hold: float  # k, at which the reference is pulled to the robot's motion [1/s]
    catch_up: float  # q, of the way fallen behind [1/s]
    forget: float  # f, at which that way is forgotten [1/s]
    farthest: float  # largest way remembered [m]
    preview: float  # t, by which the reference is foreseen [s]
    yaw_rate_limit: float  # [rad/s]
    deadband: float  # wanted speed below which the robot is told to rest [m/s]


@dataclass(frozen=True, kw_only=True)
class HandPoint(PointMass):
    """Gains of the hand point."""

    offset: float  # l, of the hand point ahead of the centre [m]
    turning_speed: float  # v0, below which the turning of the reference counts less [m/s]


@dataclass(frozen=True, kw_only=True)
class Heading(PointMass):
    """Gains of heading and reverse."""

    heading_gain: float  # g [1/s]


class Reference(NamedTuple):
    """What the point mass that is imitated does."""

    velocity_w: Array  # v_ref, (2, ...) [m/s]
    lag_w: Array  # way by which the robot has fallen behind, (2, ...) [m]


class Motion(NamedTuple):
    """What the traction law is asked for."""

    speed: Array  # (...) forward [m/s]
    acceleration: Array  # (...) forward [m/s^2]
    yaw_rate: Array  # (...) [rad/s]


def rest(robots: tuple[int, ...]) -> Reference:
    """Returns the reference of robots at rest.

    Args:
        robots: Shape of their headings.
    """
    return Reference(velocity_w=np.zeros((2, *robots)), lag_w=np.zeros((2, *robots)))


def advance(
    reference: Reference,
    force_w: Array,
    forward_w: Array,
    speed: Array,
    *,
    mass: float,
    period: float,
    gains: PointMass,
) -> tuple[Reference, Array]:
    """Advances the reference over a period of held force and motion: its velocity exactly, the lag to first order.

    Args:
        reference: Before.
        force_w: Total command, (2, ...) [N].
        forward_w: e_x, (2, ...).
        speed: Measured forward speed v, (...) [m/s].
        mass: Of the point mass that is imitated [kg].
        period: Of the law [s].
        gains: Of the law.

    Returns:
        The reference after, and d v_ref / dt then, (2, ...) [m/s^2].
    """
    velocity_w = speed * forward_w
    # v_ref tends to this velocity, at which the pull balances the force.
    target_w = velocity_w + force_w / (mass * gains.hold)
    reference_w = target_w + math.exp(-gains.hold * period) * (reference.velocity_w - target_w)
    kept = math.exp(-gains.forget * period)
    lag_w = kept * (reference.lag_w + period * (reference_w - velocity_w))
    length = np.sqrt(dot(lag_w, lag_w))
    lag_w = lag_w * (gains.farthest / np.maximum(length, max(gains.farthest, 1e-12)))
    return Reference(velocity_w=reference_w, lag_w=lag_w), gains.hold * (target_w - reference_w)


def steer(
    reference: Reference,
    force_w: Array,
    axes: Axes,
    speed: Array,
    *,
    mass: float,
    period: float,
    gains: HandPoint | Heading,
) -> tuple[Reference, Motion]:
    """Advances the reference and returns the motion that follows it.

    Args:
        reference: Before.
        force_w: Total command, (2, ...) [N].
        axes: By the measured heading.
        speed: Measured forward speed, (...) [m/s].
        mass: Of the point mass that is imitated [kg].
        period: Of this law [s].
        gains: Of either law, which they choose.

    Returns:
        The reference after, and the motion to ask of the traction law.
    """
    forward_w, left_w = axes
    reference, acceleration_w = advance(reference, force_w, forward_w, speed, mass=mass, period=period, gains=gains)
    wanted_w = reference.velocity_w + gains.catch_up * reference.lag_w + gains.preview * acceleration_w
    along, across = dot(wanted_w, forward_w), dot(wanted_w, left_w)
    along_squared = along * along
    match gains:
        case HandPoint():
            turning = dot(acceleration_w, left_w) * along / (along_squared + gains.turning_speed**2)
            yaw_rate = across / gains.offset + turning
        case Heading():
            end = np.where(along < 0.0, -1.0, 1.0)
            yaw_rate = gains.heading_gain * np.arctan2(end * across, end * along)
    moving = along_squared + across * across >= gains.deadband**2
    yaw_rate = yaw_rate.clip(-gains.yaw_rate_limit, gains.yaw_rate_limit)
    asked = np.array((along, dot(force_w, forward_w) / mass, yaw_rate))
    return reference, Motion(*np.where(moving, asked, 0.0))
