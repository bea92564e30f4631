"""The design model of the tuning: a planar skid-steer vehicle in CasADi.

Body axes, x forward and y left; state (X, Y, heading, vx, vy, r, w1 .. w4) with the wheels in the order of
`traction.SIDES`. Each tyre at (x_i, y_i) slides over the ground with

    s_i = (vx - r y_i - R w_i,  vy + r x_i),        f_i = -mu N_i s_i / sqrt(|s_i|^2 + e^2),

isotropic Coulomb friction smoothed below e, under its share N_i of the weight, which leans back under acceleration and
outward in a curve. Then

    m (vx' - r vy) = sum f_ix,    m (vy' + r vx) = sum f_iy,    I_z r' = sum (x_i f_iy - y_i f_ix),
    J w_i' = torque_i - R f_ix - b w_i,

with the motors' speed loops, and their limits of current and of voltage less back-EMF. It leaves out heave, pitch and
roll but for that lean. The parameters are read from the MJCF.
"""

from dataclasses import dataclass
from typing import Any

import casadi
import numpy as np

from dynabot_mj.controllers.arrays import Array
from dynabot_mj.controllers.traction import SIDES
from dynabot_mj.controllers.vehicle import GRAVITY, Vehicle

Symbol = Any  # casadi.SX or casadi.MX

STATES = 10
STEP = 0.006  # longest step of the integration [s]; the smoothed friction would make a longer one unstable

_FRONT = np.array([1.0, 1.0, -1.0, -1.0])  # whether a wheel is in front


@dataclass(frozen=True, kw_only=True)
class Smoothing:
    """How the model is smoothed."""

    slip: float = 0.08  # e, below which friction is viscous [m/s]


_SMOOTHING = Smoothing()


def motor_torque(wheel_speed: Symbol, commanded: Symbol, feed_forward: Symbol, vehicle: Vehicle) -> Symbol:
    """Returns what the motors give at the wheels [Nm]: speed loop and feed-forward, by voltage and current limits.

    Args:
        wheel_speed: (4,) [rad/s].
        commanded: Wheel speeds, (4,) [rad/s].
        feed_forward: Torques, (4,) [Nm].
        vehicle: The vehicle's parameters.
    """
    k, stall = vehicle.torque_constant, vehicle.torque_constant * vehicle.voltage / vehicle.resistance
    drop = k * k / vehicle.resistance * wheel_speed  # torque that the back-EMF takes
    wanted = vehicle.servo_gain * (commanded - wheel_speed) + feed_forward
    by_voltage = casadi.fmin(casadi.fmax(wanted, -stall - drop), stall - drop)
    return casadi.fmin(casadi.fmax(by_voltage, -vehicle.torque_limit), vehicle.torque_limit)


def slip(state: Symbol, vehicle: Vehicle) -> tuple[Symbol, Symbol]:
    """Returns how the four tyres slide over the ground, along their wheels and sideways, 2 x (4,) [m/s]."""
    vx, vy, r, wheels = state[3], state[4], state[5], state[6:10]
    side, front = casadi.DM(SIDES), casadi.DM(_FRONT)
    along = vx + 0.5 * vehicle.track * side * r - vehicle.wheel_radius * wheels
    across = vy + (0.5 * vehicle.wheelbase * front - vehicle.mass_centre_forward) * r
    return along, across


def derivative(
    state: Symbol, commanded: Symbol, feed_forward: Symbol, vehicle: Vehicle, smoothing: Smoothing = _SMOOTHING
) -> Symbol:
    """Returns the time derivative of the state.

    Args:
        state: See the module, (10,).
        commanded: Wheel speeds, (4,) [rad/s].
        feed_forward: Torques, (4,) [Nm].
        vehicle: The vehicle's parameters.
        smoothing: Of the friction.
    """
    heading, vx, vy, r, wheels = state[2], state[3], state[4], state[5], state[6:10]
    front = casadi.DM(_FRONT)
    load = vehicle.mass * GRAVITY / 4.0 * (1.0 + 2.0 * vehicle.mass_centre_forward / vehicle.wheelbase * front)
    along, across = slip(state, vehicle)
    slide = casadi.sqrt(along * along + across * across + smoothing.slip**2)
    share_x, share_y = -vehicle.friction * along / slide, -vehicle.friction * across / slide
    # The weight that leans back and out, by the forces that the loads at rest would give.
    lean = vehicle.mass_centre_height / 2.0
    back = lean * casadi.sum1(share_x * load) / vehicle.wheelbase
    right = lean * casadi.sum1(share_y * load) / vehicle.track
    load = casadi.fmax(load - front * back + casadi.DM(SIDES) * right, 0.0)
    force_x, force_y = share_x * load, share_y * load
    arm_x = 0.5 * vehicle.wheelbase * front - vehicle.mass_centre_forward
    arm_y = -0.5 * vehicle.track * casadi.DM(SIDES)  # the left wheels, whose side is -1, lie at positive y
    torque = motor_torque(wheels, commanded, feed_forward, vehicle)
    spin = (torque - vehicle.wheel_radius * force_x - vehicle.wheel_damping * wheels) / vehicle.wheel_inertia
    return casadi.vertcat(
        vx * casadi.cos(heading) - vy * casadi.sin(heading),
        vx * casadi.sin(heading) + vy * casadi.cos(heading),
        r,
        casadi.sum1(force_x) / vehicle.mass + r * vy,
        casadi.sum1(force_y) / vehicle.mass - r * vx,
        casadi.sum1(arm_x * force_y - arm_y * force_x) / vehicle.yaw_inertia,
        spin,
    )


def advance(
    state: Symbol,
    commanded: Symbol,
    feed_forward: Symbol,
    period: float,
    vehicle: Vehicle,
    smoothing: Smoothing = _SMOOTHING,
) -> Symbol:
    """Returns the state after a period under held commands, by Runge-Kutta's fourth-order method."""
    steps = int(np.ceil(period / STEP - 1e-9))
    h = period / steps
    for _ in range(steps):
        k1 = derivative(state, commanded, feed_forward, vehicle, smoothing)
        k2 = derivative(state + 0.5 * h * k1, commanded, feed_forward, vehicle, smoothing)
        k3 = derivative(state + 0.5 * h * k2, commanded, feed_forward, vehicle, smoothing)
        k4 = derivative(state + h * k3, commanded, feed_forward, vehicle, smoothing)
        state = state + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return state


def simulate(start: Array, commanded: Array, feed_forward: Array, period: float, vehicle: Vehicle) -> Array:
    """Drives the model by a sequence of commands.

    Args:
        start: State, (10,).
        commanded: Wheel speeds, each held for a period, (K, 4) [rad/s].
        feed_forward: Torques, (K, 4) [Nm].
        period: [s].
        vehicle: The vehicle's parameters.

    Returns:
        The states after each period, (K, 10).
    """
    x, w, t = casadi.SX.sym("x", STATES), casadi.SX.sym("w", 4), casadi.SX.sym("t", 4)
    step = casadi.Function("step", [x, w, t], [advance(x, w, t, period, vehicle)])
    return np.array(step.mapaccum(len(commanded))(start, commanded.T, feed_forward.T)).T
