"""Gains of the local laws by optimal control: parameters in, gains out.

The design model is `planar_model` under the laws of `steering` and `traction`, written once more in CasADi, with a
delay of one local period between measuring and acting: without it the gains that come out are too sharp for the real
loop. Beside each vehicle a particle moves under the same forces of the field, each with the dissipation of its own
motion. IPOPT minimises, over all courses and control periods, the mean of

    |v - v_p|^2 + w_p |p - p_p|^2  +  soft limits of motor current, wheel slip and yaw acceleration.

It is a sum of squares r.r of gains scaled to their bounds, so the Hessian is taken as 2 J^T J (Gauss-Newton).
"""

import contextlib
import math
import signal
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

import casadi
import numpy as np

from dynabot_mj.controllers import planar_model
from dynabot_mj.controllers.arrays import Array
from dynabot_mj.controllers.gains import Gains
from dynabot_mj.controllers.steering import HandPoint, Heading
from dynabot_mj.controllers.traction import SIDES, Traction
from dynabot_mj.controllers.vehicle import Vehicle

Symbol = Any  # casadi.SX or casadi.MX
Progress = Callable[[int, float], None]  # told the iteration and its cost

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
class Solution:
    """Outcome of a tuning."""

    gains: Gains
    cost_before: float  # in the design model
    cost_after: float
    iterations: int
    converged: bool
    status: str  # IPOPT's
    history: list[float]  # cost of each iteration


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


def tune(
    problem: Problem, start: Gains, progress: Progress = lambda iteration, cost: None, limit: int = 100
) -> Solution:
    """Tunes gains.

    Args:
        problem: What for.
        start: Where to begin; gains that are not tuned stay these.
        progress: Called with every iteration.
        limit: Of the iterations.

    Raises:
        KeyboardInterrupt: If it was interrupted.
    """
    names = free(problem.steering)
    low, high = (np.array([BOUNDS[name][side] for name in names]) for side in (0, 1))
    share = casadi.MX.sym("share", len(names))
    residual = _residual(problem, start)(low + (high - low) * share)
    slope = casadi.jacobian(residual, share)
    scale, multipliers = casadi.MX.sym("scale"), casadi.MX.sym("multipliers", 0)
    hessian = casadi.triu(2.0 * scale * slope.T @ slope)
    watch = _Watch(len(names), progress)
    options: Any = {
        "hess_lag": casadi.Function("hess_lag", [share, casadi.MX(0, 1), scale, multipliers], [hessian]),
        "print_time": False,
        "iteration_callback": watch,
        "ipopt": {
            "print_level": 0,
            "sb": "yes",
            "mu_strategy": "adaptive",
            "max_iter": limit,
            "tol": 1e-4,
            # The laws' limits leave kinks in the cost, at which the gradient need not vanish.
            "acceptable_tol": 1e3,
            "acceptable_iter": 5,
            "acceptable_obj_change_tol": 2e-4,
        },
    }
    solver = casadi.nlpsol("solver", "ipopt", {"x": share, "f": casadi.sumsqr(residual)}, options)
    first = np.array([{**asdict(getattr(start, problem.steering)), **asdict(start.traction)}[name] for name in names])
    with _held_back(watch.came):
        result = solver(x0=np.clip((first - low) / (high - low), 0.0, 1.0), lbx=0.0, ubx=1.0)
    if watch.interrupted:
        raise KeyboardInterrupt
    stats = solver.stats()
    # The solver may stop a step or two behind the best point that it has seen; where it broke down, its result is no
    # point at all.
    last = float(result["f"]) if stats["success"] else math.inf
    best = watch.best if watch.lowest <= last else np.array(result["x"]).ravel()
    found = low + (high - low) * best
    before, after = float(casadi.sumsqr(_residual(problem, start)(first))), min(watch.lowest, last)
    # A start outside the bounds may be better than all within them.
    tuned = _with(start, problem.steering, dict(zip(names, found.tolist(), strict=True))) if after < before else start
    return Solution(
        gains=tuned,
        cost_before=before,
        cost_after=min(before, after),
        iterations=int(stats["iter_count"]),
        converged=bool(stats["success"]),
        status=str(stats["return_status"]),
        history=watch.history,
    )


def respond(problem: Problem, gains: Gains) -> Response:
    """Runs the design model on all courses.

    Args:
        problem: The courses.
        gains: Of the laws.
    """
    states = np.stack([np.array(one) for one in _run(problem, gains)(_values(problem, gains), *_inputs(problem))[0]])
    x = states.transpose(0, 2, 1)
    cos, sin = np.cos(x[..., 2]), np.sin(x[..., 2])
    vx, vy = x[..., 3], x[..., 4]
    return Response(
        velocity_w=np.stack([cos * vx - sin * vy, sin * vx + cos * vy], axis=-1),
        position_w=x[..., :2],
        particle_velocity_w=x[..., _PARTICLE + 2 : _PARTICLE + 4],
        particle_position_w=x[..., _PARTICLE : _PARTICLE + 2],
    )


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
    return reference, lag, along, casadi.dot(force, forward) / mass, _clip(yaw_rate, gains["yaw_rate_limit"])


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
    torque = _clip(push + scrub * sides, vehicle.torque_limit)
    ahead = vehicle.wheel_radius * torque / vehicle.servo_gain
    limit = gains["slip_limit"] + gains["slip_share"] * casadi.fabs(ground)
    return (ground + _clip(wanted + ahead - ground, limit) - ahead) / vehicle.wheel_radius, torque


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
        reference, lag, speed, acceleration, yaw_rate = steer(
            reference, lag, total_w, x[2], x[3], vehicle.mass, period, table
        )
        wheel_speed, torque = drive(speed, acceleration, yaw_rate, x[3], x[5], vehicle, table)
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

    def run(values: Symbol, starts: Array, forces: Array, wells: Array) -> tuple[list[Symbol], Symbol]:
        states, residuals = [], []
        for start, force, well in zip(starts, forces, wells, strict=True):
            state, residual = course(start, casadi.repmat(values, 1, count), force.T, casadi.repmat(well, 1, count))
            states.append(state)
            residuals.append(casadi.vec(residual) / math.sqrt(count * len(starts)))
        return states, casadi.vertcat(*residuals)

    return run


def _residual(problem: Problem, gains: Gains) -> casadi.Function:
    values = casadi.MX.sym("g", len(free(problem.steering)))
    return casadi.Function("residual", [values], [_run(problem, gains)(values, *_inputs(problem))[1]])


def _inputs(problem: Problem) -> tuple[Array, Array, Array]:
    """Returns the courses' starts, forces and wells, (S, 34), (S, K, 2), (S, 4)."""
    starts = np.zeros((len(problem.force_w), _STATES))
    starts[:, :2] = starts[:, _PARTICLE : _PARTICLE + 2] = problem.start_w
    wells = np.column_stack([problem.well_gain, problem.neighbour_gain, problem.neighbour_w])
    return starts, problem.force_w, wells


def _values(problem: Problem, gains: Gains) -> Array:
    table = {**asdict(getattr(gains, problem.steering)), **asdict(gains.traction)}
    return np.array([table[name] for name in free(problem.steering)])


def _with(gains: Gains, steering: str, values: Mapping[str, float]) -> Gains:
    """Returns the gains with some values replaced."""

    def own(table: Any) -> Any:
        return replace(table, **{f.name: values[f.name] for f in fields(table) if f.name in values})

    return replace(gains, traction=own(gains.traction), **{steering: own(getattr(gains, steering))})


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


def _clip(value: Symbol, limit: Symbol) -> Symbol:
    """Limits a value, smoothly: a kink would stop the solver. At the limit it is 7 % low, at half of it right."""
    return value / (1.0 + casadi.fabs(value / limit) ** 10) ** 0.1


@contextlib.contextmanager
def _held_back(came: list[int]) -> Iterator[None]:
    """Notes the signals that end a program in `came` while compiled code runs, which would swallow what they raise.

    They are raised again afterwards, for whoever takes them.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread takes signals
        return
    ending = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
    # One that is ignored stays so.
    handlers = {one: signal.getsignal(one) for one in ending if signal.getsignal(one) is not signal.SIG_IGN}
    for one in handlers:
        signal.signal(one, lambda number, frame: came.append(number))
    try:
        yield
    finally:
        for one, handler in handlers.items():
            signal.signal(one, handler)
    if came:
        signal.raise_signal(came[0])


class _Watch(casadi.Callback):
    """Tells the progress of the solver, and stops it on Ctrl-C."""

    def __init__(self, size: int, progress: Progress) -> None:
        casadi.Callback.__init__(self)
        self._size, self._progress = size, progress
        self.history: list[float] = []
        self.lowest, self.best = math.inf, np.zeros(size)
        self.interrupted = False
        self.came: list[int] = []  # signals that end the program
        self.construct("watch", {})

    def get_n_in(self) -> int:
        return int(casadi.nlpsol_n_out())

    def get_n_out(self) -> int:
        return 1

    def get_name_in(self, index: int) -> str:
        return str(casadi.nlpsol_out(index))

    def get_sparsity_in(self, index: int) -> casadi.Sparsity:
        name = casadi.nlpsol_out(index)
        size = {"f": 1, "x": self._size, "lam_x": self._size}.get(name, 0)
        return casadi.Sparsity.dense(size, 1) if size else casadi.Sparsity(0, 1 if name in ("g", "lam_g") else 0)

    def eval(self, arguments: Sequence[Any]) -> list[Any]:
        """Takes an iteration's result; anything but 0 stops the solver."""
        result = {casadi.nlpsol_out(index): value for index, value in enumerate(arguments)}
        self.history.append(float(result["f"]))
        if self.history[-1] < self.lowest:
            self.lowest, self.best = self.history[-1], np.array(result["x"]).ravel()
        try:
            self._progress(len(self.history) - 1, self.history[-1])
        except KeyboardInterrupt:
            self.interrupted = True
        return [int(self.interrupted or bool(self.came))]
