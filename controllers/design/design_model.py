"""The design model of the local laws: courses of force that vehicle and particle go through, in CasADi.

The vehicle is `planar_model` under `symbolic_laws`, with a delay of one local period between measuring and acting:
without it the gains that come out are too sharp for the real loop. Beside each vehicle a particle moves under the same
forces of the field, each with the dissipation of its own motion. Residuals, whose squares are the cost, are

    v - v_p,   sqrt(w_p) (p - p_p),   soft limits of motor current, wheel slip and yaw acceleration.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any

import casadi
import numpy as np

from dynabot_mj.controllers.arrays import Array
from dynabot_mj.controllers.design import planar_model, symbolic_laws
from dynabot_mj.controllers.design.symbolic_laws import Symbol
from dynabot_mj.controllers.gains import Gains
from dynabot_mj.controllers.steering import HandPoint, Heading
from dynabot_mj.controllers.traction import Traction
from dynabot_mj.controllers.vehicle import Vehicle

# What the tuning may change, and within which bounds; all other gains stay what they are.
BOUNDS: Mapping[str, tuple[float, float]] = {
    "hold": (0.5, 4.0),
    "catch_up": (0.0, 1.5),
    "forget": (0.05, 1.0),
    "preview": (0.0, 0.3),
    "offset": (0.15, 0.8),
    "turning_speed": (0.2, 2.0),
    "heading_gain": (1.0, 12.0),
    "speed_gain": (0.0, 2.0),
    "yaw_gain": (0.3, 3.0),
    "scrub_torque": (0.5, 1.9),
    "scrub_rate": (0.1, 1.5),
}


@dataclass(frozen=True, kw_only=True)
class Weights:
    """Of the terms of the cost beside the velocity error."""

    position: float = 0.1  # w_p [1/s^2]
    current: float = 0.01  # of a motor's squared excess over its limit, relative to it [m^2/s^2]
    slip: float = 0.02  # of a tyre's squared slip beyond `largest_slip`
    yaw_acceleration: float = 0.01  # of the squared yaw acceleration relative to `largest_yaw_acceleration` [m^2/s^2]
    largest_slip: float = 1.0  # along a wheel [m/s]
    largest_yaw_acceleration: float = 40.0  # [rad/s^2]


@dataclass(frozen=True, kw_only=True)
class Problem:
    """What to tune for: S courses of K control periods."""

    vehicle: Vehicle
    dissipation: float  # c [N s/m]
    well_radius: float  # h0 [m]
    well_width: float  # epsilon [m]
    spacing: float  # d0 [m]
    force_w: Array  # (S, K, 2) beside the wells' [N]
    well_gain: Array  # (S,) alpha_h; 0: no well [N m]
    neighbour_gain: Array  # (S,) alpha_d of a robot that stands there; 0: none [N m]
    neighbour_w: Array  # (S, 2) its place from the well's centre [m]
    start_w: Array  # (S, 2) from the well's centre; headings are zero [m]
    period: float  # T_c [s]
    local_periods: int  # of the local laws in one control period
    steering: str = "hand_point"  # or "heading": whose gains are tuned
    weights: Weights = Weights()


@dataclass(frozen=True, kw_only=True)
class Response:
    """What the design model does on each course."""

    velocity_w: Array  # (S, K, 2) [m/s]
    position_w: Array  # (S, K, 2) [m]
    particle_velocity_w: Array  # (S, K, 2) [m/s]
    particle_position_w: Array  # (S, K, 2) [m]


def free(steering: str) -> list[str]:
    """Returns the names of the gains that are tuned with a law."""
    tables = {"hand_point": HandPoint, "heading": Heading}[steering], Traction
    return [field.name for table in tables for field in fields(table) if field.name in BOUNDS]


def values(problem: Problem, gains: Gains) -> Array:
    """Returns the values of the gains that are tuned, in the order of `free`."""
    table = {**asdict(getattr(gains, problem.steering)), **asdict(gains.traction)}
    return np.array([table[name] for name in free(problem.steering)])


def residual(problem: Problem, gains: Gains) -> casadi.Function:
    """Builds the function from the tuned gains' values to the residuals of all courses."""
    symbols = casadi.MX.sym("g", len(free(problem.steering)))
    return casadi.Function("residual", [symbols], [_run(problem, gains)(symbols, *_inputs(problem))[1]])


def respond(problem: Problem, gains: Gains) -> Response:
    """Runs the design model on all courses.

    Args:
        problem: The courses.
        gains: Of the laws.
    """
    states = np.stack([np.array(one) for one in _run(problem, gains)(values(problem, gains), *_inputs(problem))[0]])
    x = states.transpose(0, 2, 1)
    cos, sin = np.cos(x[..., 2]), np.sin(x[..., 2])
    vx, vy = x[..., 3], x[..., 4]
    return Response(
        velocity_w=np.stack([cos * vx - sin * vy, sin * vx + cos * vy], axis=-1),
        position_w=x[..., :2],
        particle_velocity_w=x[..., _PARTICLE + 2 : _PARTICLE + 4],
        particle_position_w=x[..., _PARTICLE : _PARTICLE + 2],
    )


# Where the parts of a course's state begin: vehicle, reference, lag, commands under way, particle.
_REFERENCE = planar_model.STATES
_LAG, _COMMANDS, _PARTICLE = _REFERENCE + 2, _REFERENCE + 4, _REFERENCE + 12
_STATES = _PARTICLE + 4


def _step(problem: Problem, gains: Gains) -> casadi.Function:
    """Builds one control period of one course: state, tuned gains, force and well -> state and residual."""
    names = free(problem.steering)
    values, force_w = casadi.SX.sym("g", len(names)), casadi.SX.sym("f", 2)
    wells = casadi.SX.sym("w", 4)  # gains of well and neighbour, place of the neighbour
    table: dict[str, Any] = {**asdict(getattr(gains, problem.steering)), **asdict(gains.traction)}
    table |= {name: values[index] for index, name in enumerate(names)}
    vehicle, weights = problem.vehicle, problem.weights
    period = problem.period / problem.local_periods
    start: Symbol = casadi.SX.sym("x", _STATES)
    x, reference, lag = start[:_REFERENCE], start[_REFERENCE:_LAG], start[_LAG:_COMMANDS]
    commands, p, v = start[_COMMANDS:_PARTICLE], start[_PARTICLE : _PARTICLE + 2], start[_PARTICLE + 2 :]

    field_w = force_w + _field(x[:2], wells, problem)
    total_w = field_w - problem.dissipation * _velocity(x)
    excess = []
    for _ in range(problem.local_periods):
        reference, lag, speed, acceleration, yaw_rate = symbolic_laws.steer(
            reference, lag, total_w, x[2], x[3], vehicle.mass, period, table
        )
        wheel_speed, torque = symbolic_laws.drive(speed, acceleration, yaw_rate, x[3], x[5], vehicle, table)
        # What was decided a period ago acts now.
        after = planar_model.advance(x, commands[:4], commands[4:], period, vehicle)
        share = _excess(after, commands, (after[5] - x[5]) / period, vehicle, weights)
        excess.append(share / math.sqrt(problem.local_periods))
        x, commands = after, casadi.vertcat(wheel_speed, torque)
    push = (force_w + _field(p, wells, problem) - problem.dissipation * v) / vehicle.mass
    p, v = p + problem.period * v + 0.5 * problem.period**2 * push, v + problem.period * push
    residual = casadi.vertcat(_velocity(x) - v, math.sqrt(weights.position) * (x[:2] - p), *excess)
    end = casadi.vertcat(x, reference, lag, commands, p, v)
    return casadi.Function("step", [start, values, force_w, wells], [end, residual])


def _run(problem: Problem, gains: Gains) -> Callable[..., tuple[list[Symbol], Symbol]]:
    """Returns a function of the tuned gains' values and the courses: the states of each course, and all residuals."""
    count = problem.force_w.shape[1]
    course = _step(problem, gains).mapaccum("course", count)

    def through(values: Symbol, starts: Array, forces: Array, wells: Array) -> tuple[list[Symbol], Symbol]:
        states, residuals = [], []
        for start, force, well in zip(starts, forces, wells, strict=True):
            state, residual = course(start, casadi.repmat(values, 1, count), force.T, casadi.repmat(well, 1, count))
            states.append(state)
            residuals.append(casadi.vec(residual) / math.sqrt(count * len(starts)))
        return states, casadi.vertcat(*residuals)

    return through


def _inputs(problem: Problem) -> tuple[Array, Array, Array]:
    """Returns the courses' starts, forces and wells, (S, 34), (S, K, 2), (S, 4)."""
    starts = np.zeros((len(problem.force_w), _STATES))
    starts[:, :2] = starts[:, _PARTICLE : _PARTICLE + 2] = problem.start_w
    wells = np.column_stack([problem.well_gain, problem.neighbour_gain, problem.neighbour_w])
    return starts, problem.force_w, wells


def _excess(state: Symbol, commands: Symbol, yaw_acceleration: Symbol, vehicle: Vehicle, weights: Weights) -> Symbol:
    """Returns by how much a local period exceeds the soft limits, weighted: (9,), whose squares are to be added."""
    wanted = vehicle.servo_gain * (commands[:4] - state[6:10]) + commands[4:]
    current = casadi.fmax(casadi.fabs(wanted) / vehicle.torque_limit - 1.0, 0.0)
    slip = casadi.fmax(casadi.fabs(planar_model.slip(state, vehicle)[0]) - weights.largest_slip, 0.0)
    return casadi.vertcat(
        math.sqrt(weights.current / 4.0) * current,
        math.sqrt(weights.slip / 4.0) * slip,
        math.sqrt(weights.yaw_acceleration) * yaw_acceleration / weights.largest_yaw_acceleration,
    )


def _field(position_w: Symbol, wells: Symbol, problem: Problem) -> Symbol:
    """Returns the force of a course's well and neighbour, Eq. 8, (2,) [N]."""

    def attraction(offset_w: Symbol, radius: float) -> Symbol:
        r = casadi.sqrt(casadi.sumsqr(offset_w) + 1e-4)
        s = casadi.if_else(r <= radius, r, casadi.fmax(r - problem.well_width, radius))
        return -(1.0 / s - radius / (s * s)) / r * offset_w

    of_leader = wells[0] * attraction(position_w, problem.well_radius)
    return of_leader + wells[1] * attraction(position_w - wells[2:], problem.spacing)


def _velocity(state: Symbol) -> Symbol:
    cos, sin = casadi.cos(state[2]), casadi.sin(state[2])
    return casadi.vertcat(cos * state[3] - sin * state[4], sin * state[3] + cos * state[4])
