"""Tuning of the local laws: CasADi finds the gains on a planar model, MuJoCo judges them where they were not tuned."""

import itertools
import math
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal

import numpy as np

from dynabot_mj.common import intervals
from dynabot_mj.common.arrays import Array, Progress
from dynabot_mj.common.columns import Columns
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.common.intervals import Difference
from dynabot_mj.controllers.design import design_model, tuning
from dynabot_mj.controllers.gains import Gains
from dynabot_mj.experiments.vehicle import manoeuvres
from dynabot_mj.experiments.vehicle.manoeuvres import Courses, Manoeuvre
from dynabot_mj.experiments.vehicle.tracking import FIELD, WELL_RADIUS, Tracking, follow
from dynabot_mj.plants import scene
from dynabot_mj.plants.local_laws import LocalLaws
from dynabot_mj.plants.rigid_body import LOCAL_PERIOD
from dynabot_mj.study import execution, fleet, provenance
from dynabot_mj.study.chunk import Chunk
from dynabot_mj.study.execution import Execution, ShareWatch
from dynabot_mj.study.provenance import versions

SteeringTable = Literal["hand_point", "heading"]

COURSES, DURATION = 10, 7.0  # of the tuning, and how long each is [s]
HELD_OUT = 20  # courses of the validation
FRICTIONS = (0.3, 0.5, 0.75, 0.9)
PAYLOADS = (0.0, 4.0)  # [kg]
PERIODS = (0.010, 0.027, 0.036, 0.156)  # T_c [s]
_TUNING, _VALIDATION = 0, 1  # purposes of random manoeuvres
_ITERATIONS = 60
_HERE = Execution()  # in this process


@dataclass(frozen=True, kw_only=True)
class TuningRequest:
    """What to tune."""

    steering: SteeringTable = "hand_point"
    start: str = "first"  # gain set to start from
    against: str = "first"  # gain set that the result has to beat
    conditions: scene.Conditions = scene.NOMINAL
    period: float = 0.036  # T_c [s]
    courses: tuple[Manoeuvre, ...] = ()  # none: random ones
    seed: int = 0


@dataclass(frozen=True, kw_only=True)
class Condition:
    """A condition of the validation, and the mean costs there."""

    friction: float
    payload_kg: float
    period_ms: float
    cost_before: float
    cost_after: float


@dataclass(frozen=True, kw_only=True)
class Validation:
    """The verdict of MuJoCo on courses that the tuning did not use."""

    conditions: tuple[Condition, ...]
    cost_before: Array  # of each course, averaged over the conditions, (S,) [m^2/s^2]
    cost_after: Array  # (S,)
    improvement: Difference  # of the two

    @property
    def better(self) -> bool:
        """Whether the costs fell for certain: the interval of the improvement is above zero."""
        return self.improvement.low is not None and self.improvement.low > 0.0


@dataclass(frozen=True, kw_only=True)
class Result:
    """A tuning and its validation."""

    request: TuningRequest
    courses: Courses
    solution: tuning.Solution
    validation: Validation
    before: Tracking  # on the courses of the tuning, with the gains to beat
    after: Tracking

    @property
    def adopted(self) -> bool:
        """Whether the gains take the place of those to beat: better for certain, by a solver that has succeeded."""
        return self.solution.converged and self.validation.better

    @property
    def provenance(self) -> dict[str, Any]:
        """How the gains were found, for the gain file."""
        solution, improvement = self.solution, self.validation.improvement
        return {
            "steering": self.request.steering,
            "start": self.request.start,
            "against": self.request.against,
            "seed": self.request.seed,
            "period_s": self.request.period,
            "model": self.request.conditions.model,
            "payload_kg": self.request.conditions.payload,
            "friction": scene.read_robot(self.request.conditions).vehicle.friction,
            "courses": "given" if self.request.courses else "random",
            "versions": versions(),
            "iterations": solution.iterations,
            "status": solution.status,
            "cost_before": solution.cost_before,
            "cost_after": solution.cost_after,
            "validation_cost_before": float(self.validation.cost_before.mean()),
            "validation_cost_after": float(self.validation.cost_after.mean()),
            "validation_improvement": [one for one in (improvement.low, improvement.high) if one is not None],
            "adopted": self.adopted,
        }


def run(request: TuningRequest, progress: Progress = lambda share: None, how: Execution = _HERE) -> Result:
    """Tunes, and validates.

    Args:
        request: What for.
        progress: Told the share of the work that is done.
        how: How the validation is executed.

    Raises:
        InputError: If there is no such model or gain set, or a value is not allowed.
    """
    check(request)
    start, against = fleet.gain_set(request.start), fleet.gain_set(request.against)
    given = list(request.courses) or manoeuvres.random(request.seed, COURSES, _TUNING)
    courses = manoeuvres.sampled(given, DURATION, request.period)
    task = problem(request, courses)
    solution = tuning.tune(
        task, start, lambda iteration, cost: progress(0.6 * min(1.0, iteration / _ITERATIONS)), _ITERATIONS
    )
    validation = validate(request, against, solution.gains, lambda share: progress(0.6 + 0.4 * share), how)
    before, after = (follow(courses, laws(one, request), request.conditions) for one in (against, solution.gains))
    return Result(
        request=request, courses=courses, solution=solution, validation=validation, before=before, after=after
    )


def check(request: TuningRequest) -> None:
    """Checks a request before any work.

    Raises:
        InputError: If a value is not allowed, or there is no such model or gain set.
    """
    if not 0.005 <= request.period <= 0.5:
        raise InputError(f"a period of {request.period:g} s given, it must be 0.005 to 0.5 s")
    if request.seed < 0:
        raise InputError(f"seed {request.seed} given, it must not be negative")
    for name in (request.start, request.against):
        fleet.gain_set(name)
    scene.read_robot(request.conditions)


def problem(request: TuningRequest, courses: Courses) -> design_model.Problem:
    """Returns the optimal control problem of courses."""
    return design_model.Problem(
        vehicle=scene.read_robot(request.conditions).vehicle,
        dissipation=FIELD.dissipation,
        well_radius=WELL_RADIUS,
        well_width=FIELD.width,
        spacing=FIELD.spacing,
        force_w=courses.force_w,
        well_gain=courses.gain,
        neighbour_gain=courses.neighbour_gain,
        neighbour_w=courses.neighbour_w,
        start_w=courses.start_w,
        period=request.period,
        local_periods=math.ceil(request.period / LOCAL_PERIOD - 1e-9),
        steering=request.steering,
    )


def laws(gains: Gains, request: TuningRequest) -> LocalLaws:
    """Returns the local laws with a gain set."""
    return LocalLaws(steering=getattr(gains, request.steering), traction=gains.traction)


def _validation_chunk(
    request: TuningRequest, pair: tuple[Gains, Gains], frictions: tuple[float, ...], payload: float, period: float
) -> Chunk:
    """Returns the courses with two gain sets, a payload [kg] and a period [s]."""
    conditions = replace(request.conditions, payload=payload, friction=None)
    inputs = {
        "conditions": asdict(conditions),
        "steering": request.steering,
        "gains": [asdict(one) for one in pair],
        "frictions": list(frictions),
        "period": period,
        "seed": request.seed,
    }
    return Chunk(
        label=f"{payload:g} kg, {period:g} s",
        inputs={**inputs, "inputs": provenance.digests({"model": scene.path(conditions.model)})},
        work=_costs,
        arguments=(request, pair, frictions, conditions, period),
    )


def _costs(
    request: TuningRequest,
    pair: tuple[Gains, Gains],
    frictions: tuple[float, ...],
    conditions: scene.Conditions,
    period: float,
    *,
    threads: int,
    progress: Progress,
) -> Columns:
    """Returns the cost of each course, (2, frictions, S) [m^2/s^2]."""
    courses = manoeuvres.sampled(manoeuvres.random(request.seed, HELD_OUT, _VALIDATION), DURATION, period)
    weight, count = design_model.Weights().position, len(frictions)
    # All frictions at once: the courses repeated for each.
    repeated, friction = _repeated(courses, count), np.repeat(frictions, HELD_OUT)
    costs = [follow(repeated, laws(one, request), conditions, friction).cost(weight).reshape(count, -1) for one in pair]
    return {"cost": np.stack(costs)}


def validate(
    request: TuningRequest,
    before: Gains,
    after: Gains,
    progress: Progress = lambda share: None,
    how: Execution = _HERE,
) -> Validation:
    """Judges two gain sets in MuJoCo on courses that the tuning did not use, over friction, payload and period.

    A course's cost is averaged over the conditions, and the courses are the sample of the interval: conditions of one
    course are not independent.
    """
    frictions = tuple(sorted({*FRICTIONS, scene.read_robot(request.conditions).vehicle.friction}))
    payloads = sorted({*PAYLOADS, request.conditions.payload})
    periods = sorted({*PERIODS, request.period})
    places = list(itertools.product(payloads, periods))
    chunks = [_validation_chunk(request, (before, after), frictions, payload, period) for payload, period in places]
    results = execution.execute(chunks, how, ShareWatch(progress))
    costs = [results[index]["cost"] for index in range(len(chunks))]
    found = [
        Condition(
            friction=value,
            payload_kg=payload,
            period_ms=1e3 * period,
            cost_before=float(pair[0, index].mean()),
            cost_after=float(pair[1, index].mean()),
        )
        for (payload, period), pair in zip(places, costs, strict=True)
        for index, value in enumerate(frictions)
    ]
    cost_before, cost_after = np.concatenate(costs, axis=1).mean(axis=1)
    return Validation(
        conditions=tuple(found),
        cost_before=cost_before,
        cost_after=cost_after,
        improvement=intervals.paired_difference(cost_before, cost_after, request.seed),
    )


def _repeated(courses: Courses, times: int) -> Courses:
    """Returns courses repeated as a whole."""

    def tiled(array: Array) -> Array:
        return np.tile(array, (times, *[1] * (array.ndim - 1)))

    return Courses(
        force_w=tiled(courses.force_w),
        gain=tiled(courses.gain),
        neighbour_gain=tiled(courses.neighbour_gain),
        neighbour_w=tiled(courses.neighbour_w),
        start_w=tiled(courses.start_w),
        period=courses.period,
    )
