"""The tracking report: how well vehicles imitate particles, for each steering law and gain set.

On courses of force, on the formation with perfect information at the periods of Table III, and on the formation over
friction.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from dynabot_mj.common import columns, intervals
from dynabot_mj.common.arrays import Array, Progress, rms
from dynabot_mj.common.columns import Columns
from dynabot_mj.common.intervals import Difference, Mean, MeanInterval, Rate
from dynabot_mj.experiments.vehicle import formation_tracking, manoeuvres, tracking
from dynabot_mj.experiments.vehicle.formation_tracking import FormationTracking
from dynabot_mj.experiments.vehicle.tracking import Tracking
from dynabot_mj.formation import metrics
from dynabot_mj.plants.options import SteeringName
from dynabot_mj.study import configuration, execution, fleet, provenance, scenario
from dynabot_mj.study.chunk import Chunk
from dynabot_mj.study.execution import Execution, ShareWatch
from dynabot_mj.study.scenario import Scenario
from dynabot_mj.testbed import paper

COURSES_PER_KIND, COURSE_DURATION, COURSE_PERIOD = 8, 7.0, 0.036  # [s]
FRICTIONS = (0.15, 0.2, 0.25, 0.3, 0.5, 0.75, 0.9)
# Of the formations: T_c of Table III, and the row whose gains go with it; all laws are compared at some of them.
PERIODS = ((0.010, "perfect"), (0.027, "perfect"), (0.036, "perfect"), (0.156, "coupled"))
COMPARED_PERIODS = (0.036, 0.156)
_PURPOSE = 2  # of the random manoeuvres: neither those of the tuning nor those of its validation


@dataclass(frozen=True, kw_only=True)
class Laws:
    """A steering law with a gain set."""

    steering: SteeringName
    gains: str

    @property
    def label(self) -> str:
        """E.g. `hand-point, tuned`."""
        return f"{self.steering}, {self.gains}"


LAWS = (
    Laws(steering="hand-point", gains="first"),
    Laws(steering="hand-point", gains="tuned"),
    Laws(steering="heading", gains="first"),
    Laws(steering="heading", gains="tuned"),
)
TUNED = LAWS[1]


@dataclass(frozen=True, kw_only=True)
class CourseRow:
    """One law on the courses of one kind."""

    laws: str
    kind: str
    velocity_rms_mps: float
    position_rms_m: float


@dataclass(frozen=True, kw_only=True)
class FormationRow:
    """One law in the formation, beside the same trials of particles."""

    laws: str
    period_ms: float
    alpha_h: float
    alpha_d: float
    friction: float
    trials: int
    formation_s: MeanInterval  # restricted to the duration
    particle_formation_s: MeanInterval
    formation_delay_s: Difference  # rigid - particle
    settling_s: Mean
    particle_settling_s: Mean
    unsettled: Rate
    velocity_rms_mps: float
    position_rms_m: float
    largest_yaw_path_rad: float  # in the last 10 s
    largest_slip_mps: float
    collision_footprint: Rate
    hull_contact: Rate
    completion: Rate
    completion_common: Rate
    diverged: int


@dataclass(frozen=True, kw_only=True)
class TrackReport:
    """What was found."""

    seed: int
    courses: tuple[CourseRow, ...]
    formations: tuple[FormationRow, ...]  # over laws and periods
    frictions: tuple[FormationRow, ...]  # of the tuned hand point
    examples: dict[str, Tracking]  # by law, on one course of each of `manoeuvres.KINDS`
    errors_by_time: dict[str, Array]  # of the formation at 36 ms by law: RMS velocity error in each second [m/s]


@dataclass(frozen=True, kw_only=True)
class _Formation:
    """One formation study."""

    laws: Laws
    setup: Scenario


def chunks(seed: int, trials: int) -> list[Chunk]:
    """Returns the work: formations over laws and periods, formations over friction, and courses with each law.

    Args:
        seed: Of courses and trials.
        trials: Of each formation.
    """
    return [*map(_formation_chunk, _formations(seed, trials)), *(_courses_chunk(seed, laws) for laws in LAWS)]


def _formations(seed: int, trials: int) -> list[_Formation]:
    return [
        *(
            _formation(laws, seed, trials, period, row)
            for period, row in PERIODS
            for laws in LAWS
            if laws == TUNED or period in COMPARED_PERIODS
        ),
        *(_formation(TUNED, seed, trials, COURSE_PERIOD, "perfect", friction) for friction in FRICTIONS),
    ]


def _formation_chunk(one: _Formation) -> Chunk:
    period, friction = scenario.method(one.setup, "perfect").sample_period, one.setup.vehicle.friction
    return Chunk(
        label=f"{one.laws.label}, {period:g} s, friction {friction}",
        inputs={"formation tracking": provenance.depends_on(one.setup)},
        work=_tracked,
        arguments=(one.setup,),
    )


def _tracked(setup: Scenario, *, threads: int, progress: Progress) -> Columns:
    return columns.flatten(formation_tracking.follow(setup, range(setup.trials)))


def _courses_chunk(seed: int, laws: Laws) -> Chunk:
    setup = configuration.build({"vehicle": {"steering": laws.steering, "gains": laws.gains}})
    courses = {"seed": seed, "per_kind": COURSES_PER_KIND, "duration": COURSE_DURATION}
    return Chunk(
        label=f"courses, {laws.label}",
        inputs={"courses": courses, "vehicle": provenance.depends_on(setup)},
        work=_driven,
        arguments=(setup, *courses.values()),
    )


def _driven(setup: Scenario, seed: int, per_kind: int, duration: float, *, threads: int, progress: Progress) -> Columns:
    """Drives all courses of one kind, then all of the next."""
    drawn = manoeuvres.of_each_kind(seed, per_kind, _PURPOSE)
    courses = manoeuvres.sampled(drawn, duration, COURSE_PERIOD)
    return columns.flatten(tracking.follow(courses, fleet.local_laws(setup)))


def run(seed: int, trials: int, how: Execution, progress: Progress = lambda share: None) -> TrackReport:
    """Runs everything.

    Args:
        seed: Of courses and trials.
        trials: Of each formation.
        how: How the formations are executed.
        progress: Told the share of the work that is done.
    """
    tasks = _formations(seed, trials)
    split = len(tasks) - len(FRICTIONS)
    results = execution.execute(chunks(seed, trials), how, ShareWatch(progress))
    found = [columns.restore(FormationTracking, results[index]) for index in range(len(tasks))]
    driven = {laws.label: columns.restore(Tracking, results[len(tasks) + index]) for index, laws in enumerate(LAWS)}
    rows = [_row(task, outcome) for task, outcome in zip(tasks, found, strict=True)]
    return TrackReport(
        seed=seed,
        courses=tuple(_course_rows(driven)),
        formations=tuple(rows[:split]),
        frictions=tuple(rows[split:]),
        examples={law: _first_of_each(one) for law, one in driven.items()},
        errors_by_time={
            task.laws.label: outcome.velocity_error_by_time
            for task, outcome in zip(tasks[:split], found, strict=False)
            if scenario.method(task.setup, "perfect").sample_period == COURSE_PERIOD
        },
    )


def _formation(
    laws: Laws, seed: int, trials: int, period: float, row: str, friction: float | None = None
) -> _Formation:
    gains = paper.TABLE_III[row]
    vehicle: dict[str, Any] = {"steering": laws.steering, "gains": laws.gains}
    if friction is not None:
        vehicle["friction"] = friction
    method = {"sample_period": period, "alpha_h": gains.alpha_h, "alpha_d": gains.alpha_d}
    tree = {"vehicle": vehicle, "method": {"perfect": method}}
    return _Formation(laws=laws, setup=configuration.build(tree, seed=seed, trials=trials))


def _row(task: _Formation, outcome: FormationTracking) -> FormationRow:
    method, friction = scenario.method(task.setup, "perfect"), task.setup.vehicle.friction
    assert isinstance(method.sample_period, float)
    horizon = scenario.duration(task.setup)
    rigid, particle = (
        metrics.restricted(one.formation, np.fmin(one.contact, one.overturned), horizon)[~outcome.diverged]
        for one in (outcome.rigid, outcome.particle)
    )
    return FormationRow(
        laws=task.laws.label,
        period_ms=1e3 * method.sample_period,
        alpha_h=method.alpha_h,
        alpha_d=method.alpha_d,
        friction=friction if isinstance(friction, float) else 0.75,
        trials=task.setup.trials,
        formation_s=intervals.bootstrapped(rigid, task.setup.seed),
        particle_formation_s=intervals.bootstrapped(particle, task.setup.seed),
        formation_delay_s=intervals.paired_difference(rigid, particle, task.setup.seed),
        settling_s=intervals.mean(outcome.rigid.settling),
        particle_settling_s=intervals.mean(outcome.particle.settling),
        unsettled=intervals.rate(1.0 - outcome.rigid.settled),
        velocity_rms_mps=outcome.velocity_error,
        position_rms_m=outcome.position_error,
        largest_yaw_path_rad=float(outcome.yaw_path.max()),
        largest_slip_mps=float(outcome.wheel_slip.max()),
        collision_footprint=intervals.rate(outcome.rigid.collision_footprint.astype(float)),
        hull_contact=intervals.rate(outcome.hull_contact),
        completion=intervals.rate(outcome.rigid.completion),
        completion_common=intervals.rate(outcome.rigid.completion_common),
        diverged=int(outcome.diverged.sum()),
    )


def _course_rows(driven: dict[str, Tracking]) -> list[CourseRow]:
    rows = []
    for law, one in driven.items():
        for index, kind in enumerate(manoeuvres.KINDS):
            part = slice(index * COURSES_PER_KIND, (index + 1) * COURSES_PER_KIND)
            rows.append(
                CourseRow(
                    laws=law,
                    kind=kind,
                    velocity_rms_mps=float(rms(one.velocity_error[part])),
                    position_rms_m=float(rms(one.position_error[part])),
                )
            )
    return rows


def _first_of_each(driven: Tracking) -> Tracking:
    return driven.part(slice(None, None, COURSES_PER_KIND))
