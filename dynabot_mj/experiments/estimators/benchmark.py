"""What the estimators cost: time of the batched filters and of their FilterPy twins, and floating-point operations.

A step is a prediction and a bearing; every few steps there is a fix as well. Times are medians of CPU time, the
ratio of both implementations is the median of the ratios within one repetition. Operations are those of the twin, whose
matrices are dense, counted by running it on arrays that count (`operations`).
"""

import os
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from dynabot_mj.common import tables
from dynabot_mj.common.arrays import Array
from dynabot_mj.estimation.estimator import Estimator, Filter
from dynabot_mj.estimation.measurements import GpsFix, ImuSample
from dynabot_mj.experiments.estimators.operations import Counted, Tally, inverse
from dynabot_mj.perception import estimators
from dynabot_mj.perception.methods import METHODS
from dynabot_mj.study.methods import Method
from dynabot_mj.testbed import paper

ROBOTS, REPETITIONS = 300, 40
_STEPS = 10  # timed at once
_PERIOD = 0.036  # T_s [s]; what a step costs does not depend on it
_ALL = slice(None)
_NO_FORCE = np.zeros(2)
_NONE: Mapping[str, Method] = {}


@dataclass(frozen=True, kw_only=True)
class FilterRow:
    """One estimator; each quantity of a step without, and with a fix."""

    estimator: str
    batched_us: float  # per robot
    batched_fix_us: float
    estimator_us: float  # per robot, the policy of `dynabot_mj.estimation.estimator` and copies of all beliefs included
    estimator_fix_us: float
    # None of an estimator of the user's, which has no FilterPy twin.
    filterpy_us: float | None  # of one robot
    filterpy_fix_us: float | None
    ratio: float | None  # FilterPy over batched
    ratio_fix: float | None
    operations: int | None
    operations_fix: int | None
    t_se_ms: float  # of the paper's processor, or as the user has it


@dataclass(frozen=True, kw_only=True)
class FilterReport:
    """What was measured."""

    robots: int  # in the batch
    repetitions: int
    omp_num_threads: str | None  # as it is set
    rows: tuple[FilterRow, ...]

    def coupled_over_gps(self, quantity: str) -> float:
        """Returns how many times as much the coupled EKF takes as GPS extrapolation."""
        by_name = {row.estimator: row for row in self.rows}
        return float(getattr(by_name["coupled"], quantity) / getattr(by_name["gps"], quantity))


def filters(
    robots: int = ROBOTS,
    repetitions: int = REPETITIONS,
    progress: Callable[[float], None] = lambda share: None,
    own: Mapping[str, Method] = _NONE,
) -> FilterReport:
    """Measures the estimators.

    Args:
        robots: In the batch.
        repetitions: Of each time.
        progress: Told the share of the work that is done.
        own: Methods of the user's, beside those that are built in.
    """
    rows, names = [], (*estimators.NAMES, *own)
    for done, name in enumerate(names):
        rows.append(_row(name, robots, repetitions, own.get(name)))
        progress((done + 1) / len(names))
    return FilterReport(
        robots=robots,
        repetitions=repetitions,
        omp_num_threads=os.environ.get("OMP_NUM_THREADS"),
        rows=tuple(rows),
    )


def operations(name: str) -> tuple[int, int]:
    """Returns the floating-point operations of a step of the FilterPy twin, without and with a fix."""
    tally = Tally()

    def counted(values: Array) -> Counted:
        return Counted(values, tally)

    imu, fix = _imu(()), _fix(())
    imu = ImuSample(**{key: counted(value) for key, value in vars(imu).items()})
    fix = GpsFix(
        received=fix.received,
        position_w=counted(fix.position_w),
        velocity_w=counted(fix.velocity_w),
        age=counted(fix.age),
    )
    robot = estimators.twin(name)
    robot.begin(fix, imu.magnetic_heading)
    for one in robot.filters:
        one.x, one.P = counted(one.x), counted(one.P)
    counts = []
    steps: list[Callable[[], Any]] = [
        lambda: _single_step(robot, imu),
        lambda: robot.see_fix(fix, counted(_NO_FORCE)),
    ]
    for step in steps:
        tally.count = 0
        for one in robot.filters:
            one.SI = None
        step()
        # FilterPy's EKF inverts S with SciPy.
        inverted = [one.SI for one in robot.filters if one.SI is not None and not isinstance(one.SI, Counted)]
        counts.append(tally.count + sum(inverse(len(matrix)) for matrix in inverted))
    return counts[0], sum(counts)


def document(report: FilterReport) -> dict[str, Any]:
    """Returns the JSON document."""
    offset, slope, predicted = _fit(report)
    return {
        "filters": {
            "robots": report.robots,
            "repetitions": report.repetitions,
            "omp_num_threads": report.omp_num_threads,
            "rows": [asdict(row) for row in report.rows],
            "coupled_over_gps": {
                "filterpy_time": report.coupled_over_gps("filterpy_fix_us"),
                "operations": report.coupled_over_gps("operations_fix"),
                "t_se": report.coupled_over_gps("t_se_ms"),
            },
            "t_se_fit": {"offset_ms": offset, "us_per_operation": slope, "gps_ms": predicted},
        }
    }


def markdown(report: FilterReport) -> str:
    """Returns the report as a table and what it means."""

    def both(without: float | None, with_fix: float | None, form: str) -> str:
        return "-" if without is None or with_fix is None else f"{without:{form}} ({with_fix:{form}})"

    body = [
        [
            row.estimator,
            both(row.batched_us, row.batched_fix_us, ".2f"),
            both(row.estimator_us, row.estimator_fix_us, ".2f"),
            both(row.filterpy_us, row.filterpy_fix_us, ".0f"),
            both(row.ratio, row.ratio_fix, ".0f"),
            both(row.operations, row.operations_fix, "d"),
            f"{row.t_se_ms:.1f}",
        ]
        for row in report.rows
    ]
    times = [report.coupled_over_gps(key) for key in ("filterpy_fix_us", "operations_fix", "t_se_ms")]
    offset, slope, predicted = _fit(report)
    t_se_ms = 1e3 * paper.TABLE_II["gps"].estimation_time
    lines = [
        f"# Cost of the estimators, {report.robots} robots in a batch",
        "",
        *tables.aligned(
            ["estimator", "batched [us]", "with policy [us]", "FilterPy [us]", "ratio", "operations", "t_se [ms]"], body
        ),
        "",
        f"CPU time per robot and step, with a fix in parentheses; medians of {report.repetitions} repetitions.",
        "Operations: floating-point ones of the FilterPy twin. t_se: the paper's, Table II.",
        "",
        f"Python time cannot stand in for t_se: with a fix, coupled EKF over gps is {times[0]:.1f} in time of",
        f"FilterPy, where calls hide the arithmetic, {times[1]:.0f} in operations and {times[2]:.0f} in the paper.",
        f"t_se stays a parameter of the platform. {offset:.1f} ms + {slope:.1f} us per operation has both EKFs' t_se,",
        f"and gives gps {predicted:.1f} ms (paper {t_se_ms:.1f}).",
    ]
    if report.omp_num_threads != "1":
        state = "is not set" if report.omp_num_threads is None else f"is {report.omp_num_threads}"
        lines += ["", f"OMP_NUM_THREADS {state}: the times may be those of more than one core."]
    return "\n".join(lines) + "\n"


def _row(name: str, robots: int, repetitions: int, own: Method | None) -> FilterRow:
    imu, fix, everybody = _imu((robots,)), _fix((robots,)), np.ones(robots, dtype=bool)
    none = GpsFix(received=~everybody, position_w=fix.position_w, velocity_w=fix.velocity_w, age=fix.age)
    path, twin = (None, METHODS[name].twin) if own is None else (own.filter, None)
    batched = estimators.build(name, (robots,), own=path).filter
    batched.begin(_ALL, fix, imu.magnetic_heading)
    estimator: Estimator = estimators.build(name, (robots,), own=path)
    estimator.step(imu, fix, everybody)

    def batched_fix() -> None:
        _step(batched, imu)
        batched.see_fix(_ALL, fix, np.zeros((robots, 2)))

    # In the order of the row's fields.
    tasks: list[Callable[[], Any]] = [
        lambda: _step(batched, imu),
        batched_fix,
        lambda: estimator.step(imu, none, everybody),
        lambda: estimator.step(imu, fix, everybody),
        *(_twin_steps(name) if twin else ()),
    ]
    spent = np.array([[_time(task) for task in tasks] for _ in range(repetitions + 1)])[1:]  # the first warms up
    spent[:, :4] /= robots
    median = [*np.median(spent, axis=0).tolist(), None, None][:6]
    ratio = [None, None] if not twin else np.median(spent[:, 4:] / spent[:, :2], axis=0).tolist()
    counts = operations(name) if twin else (None, None)
    t_se = METHODS[name].estimation_time if own is None else own.estimation_time
    return FilterRow(
        estimator=name,
        batched_us=median[0],
        batched_fix_us=median[1],
        estimator_us=median[2],
        estimator_fix_us=median[3],
        filterpy_us=median[4],
        filterpy_fix_us=median[5],
        ratio=ratio[0],
        ratio_fix=ratio[1],
        operations=counts[0],
        operations_fix=counts[1],
        t_se_ms=1e3 * t_se,
    )


def _twin_steps(name: str) -> tuple[Callable[[], Any], Callable[[], Any]]:
    """Returns a step of the FilterPy twin without, and with a fix."""
    twin, imu, fix = estimators.twin(name), _imu(()), _fix(())
    twin.begin(fix, imu.magnetic_heading)

    def with_fix() -> None:
        _single_step(twin, imu)
        twin.see_fix(fix, _NO_FORCE)

    return lambda: _single_step(twin, imu), with_fix


def _time(task: Callable[[], Any]) -> float:
    """Returns the CPU time of a task [us]."""
    start = time.process_time()
    for _ in range(_STEPS):
        task()
    return 1e6 * (time.process_time() - start) / _STEPS


def _step(filter_: Filter, imu: ImuSample) -> None:
    filter_.predict(_ALL, imu)
    filter_.see_heading(_ALL, imu.magnetic_heading)


def _single_step(robot: Any, imu: ImuSample) -> None:
    robot.predict(imu)
    robot.see_heading(imu.magnetic_heading)


def _imu(shape: tuple[int, ...]) -> ImuSample:
    return ImuSample(
        period=np.full(shape, _PERIOD),
        specific_force_b=np.zeros((*shape, 2)),
        yaw_rate=np.zeros(shape),
        magnetic_heading=np.full(shape, 0.3),
    )


def _fix(shape: tuple[int, ...]) -> GpsFix:
    """Returns fixes of robots at rest, so that no gate closes."""
    return GpsFix(
        received=np.ones(shape, dtype=bool),
        position_w=np.zeros((*shape, 2)),
        velocity_w=np.zeros((*shape, 2)),
        age=np.full(shape, 0.1),
    )


def _fit(report: FilterReport) -> tuple[float, float, float]:
    """Returns the line t_se = offset [ms] + slope [us] x operations through both EKFs, and what it gives gps [ms]."""
    counts = {row.estimator: (row.operations_fix or 0, row.t_se_ms) for row in report.rows}
    (few, few_ms), (many, many_ms) = counts["decoupled"], counts["coupled"]
    slope = (many_ms - few_ms) / (many - few)
    offset = few_ms - slope * few
    return offset, 1e3 * slope, offset + slope * counts["gps"][0]
