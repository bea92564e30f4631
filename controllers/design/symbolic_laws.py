"""The laws of `steering` and `traction`, written once more in CasADi, smooth where a kink would stop a solver."""

from typing import Any

import casadi

from dynabot_mj.controllers.traction import SIDES
from dynabot_mj.controllers.vehicle import Vehicle

Symbol = Any  # casadi.SX or casadi.MX


def steer(
    reference: Symbol,
    lag: Symbol,
    force: Symbol,
    heading: Symbol,
    speed: Symbol,
    mass: float,
    period: float,
    gains: Any,
) -> tuple[Symbol, Symbol, Symbol, Symbol, Symbol]:
    """Repeats `steering.steer` in symbols, without its deadband and with a smooth limit.

    Returns:
        Reference and lag after; wanted speed, acceleration and yaw rate.
    """
    forward = casadi.vertcat(casadi.cos(heading), casadi.sin(heading))
    left = casadi.vertcat(-forward[1], forward[0])
    velocity = speed * forward
    target = velocity + force / (mass * gains["hold"])
    reference = target + casadi.exp(-gains["hold"] * period) * (reference - target)
    lag = casadi.exp(-gains["forget"] * period) * (lag + period * (reference - velocity))
    lag = lag * gains["farthest"] / casadi.fmax(casadi.sqrt(casadi.sumsqr(lag) + 1e-12), gains["farthest"])
    acceleration = gains["hold"] * (target - reference)
    wanted = reference + gains["catch_up"] * lag + gains["preview"] * acceleration
    along, across = casadi.dot(wanted, forward), casadi.dot(wanted, left)
    if "offset" in gains:
        turning = casadi.dot(acceleration, left) * along / (along * along + gains["turning_speed"] ** 2)
        yaw_rate = across / gains["offset"] + turning
    else:
        end = casadi.if_else(along < 0.0, -1.0, 1.0)
        yaw_rate = gains["heading_gain"] * casadi.atan2(end * across, end * along + 1e-9)
    return reference, lag, along, casadi.dot(force, forward) / mass, clip(yaw_rate, gains["yaw_rate_limit"])


def drive(
    wanted_speed: Symbol,
    acceleration: Symbol,
    wanted_yaw_rate: Symbol,
    speed: Symbol,
    yaw_rate: Symbol,
    vehicle: Vehicle,
    gains: Any,
) -> tuple[Symbol, Symbol]:
    """Repeats `traction.drive` in symbols, with smooth limits: wheel speeds and torque feed-forward, (4,) each."""
    sides = casadi.DM(SIDES)

    def at_wheels(forward: Symbol, turn: Symbol) -> Symbol:
        return forward + 0.5 * vehicle.turning_track * turn * sides

    ground = at_wheels(speed, yaw_rate)
    wanted = at_wheels(
        wanted_speed + gains["speed_gain"] * (wanted_speed - speed),
        wanted_yaw_rate + gains["yaw_gain"] * (wanted_yaw_rate - yaw_rate),
    )
    push = vehicle.effective_mass * acceleration * vehicle.wheel_radius / 4.0
    scrub = gains["scrub_torque"] * casadi.tanh(wanted_yaw_rate / gains["scrub_rate"])
    torque = clip(push + scrub * sides, vehicle.torque_limit)
    ahead = vehicle.wheel_radius * torque / vehicle.servo_gain
    limit = gains["slip_limit"] + gains["slip_share"] * casadi.fabs(ground)
    return (ground + clip(wanted + ahead - ground, limit) - ahead) / vehicle.wheel_radius, torque


def clip(value: Symbol, limit: Symbol) -> Symbol:
    """Limits a value, smoothly: a kink would stop the solver. At the limit it is 7 % low, at half of it right."""
    return value / (1.0 + casadi.fabs(value / limit) ** 10) ** 0.1
