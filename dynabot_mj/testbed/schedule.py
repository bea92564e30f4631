"""Periods that the processor can keep: Eqs. 1-3 of the paper.

Four tasks share a Dynabot's processor: control every T_c, GPS parsing every T_g, sampling (sensors, state estimation
and broadcast) every T_s, and the messages of the other n - 1 robots, which come once per T_s. Eq. 1 bounds their
summed load.

Periods are kept by a timer of whole ticks. Feasibility is judged on the exact period, before it is rounded to the tick,
as the authors must have done: their 27 and 36 ms load the processor 1.0015 and 1.0106.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from dynabot_mj.common.exceptions import InfeasibleScheduleError, InputError
from dynabot_mj.testbed.paper import FLEET_SIZE, TABLE_II, TASK_TIMES, TaskTimes

TICK = 1e-3  # the timer tick that the periods of Table III are whole multiples of [s]


def period(robots: int, estimation_time: float, utilisation_bound: float = 1.0, tasks: TaskTimes = TASK_TIMES) -> float:
    """Returns the shortest common period T_c = T_s, Eq. 3, not rounded.

    Args:
        robots: Number of robots n, 2 to 7.
        estimation_time: t_se, time of one state estimate [s].
        utilisation_bound: U, 0 < U <= 1.
        tasks: Execution times of the other tasks.

    Returns:
        The period [s].

    Raises:
        InputError: If n, t_se or U is outside its range.
        InfeasibleScheduleError: If GPS parsing alone fills the processor.

    Example:
        >>> round(dy.shortest_period(robots=3, estimation_time=0.0059), 4)  # of GPS [s]
        0.027
    """
    _check(robots, estimation_time, utilisation_bound)
    gps_load = tasks.gps / tasks.gps_period
    if gps_load >= utilisation_bound:
        raise InfeasibleScheduleError(
            f"no period is feasible: GPS parsing alone loads the processor {gps_load:.4f}, "
            f"the utilisation bound is {utilisation_bound:g}"
        )
    work = _sampling_time(robots, estimation_time, tasks) + robots * tasks.potential
    return work / (utilisation_bound - gps_load)


def utilisation(
    robots: int,
    estimation_time: float,
    sample_period: float,
    control_period: float,
    tasks: TaskTimes = TASK_TIMES,
) -> float:
    """Returns the load of the processor under given periods, the left side of Eq. 2.

    Args:
        robots: Number of robots n, 2 to 7.
        estimation_time: t_se [s].
        sample_period: T_s [s].
        control_period: T_c [s].
        tasks: Execution times of the other tasks.

    Raises:
        InputError: If an argument is outside its range.

    Example:
        >>> round(dy.processor_load(3, 0.0059, sample_period=0.027, control_period=0.027), 3)
        1.001
    """
    _check(robots, estimation_time, 1.0)
    for name, value in (("sample period", sample_period), ("control period", control_period)):
        if not value > 0.0:
            raise InputError(f"{name} {value:g} s given, it must be positive")
    control_load = robots * tasks.potential / control_period
    sampling_load = _sampling_time(robots, estimation_time, tasks) / sample_period
    return control_load + tasks.gps / tasks.gps_period + sampling_load


def require_feasible(
    robots: int,
    estimation_time: float,
    sample_period: float,
    control_period: float,
    utilisation_bound: float = 1.0,
    tick: float = TICK,
) -> None:
    """Checks that the processor can keep periods which somebody chose.

    A period in whole milliseconds stands for every period that rounds to it, as in the paper, so the load is judged
    with both half a millisecond (of a finer timer, half a tick) longer.

    Args:
        robots: Number of robots n, 2 to 7.
        estimation_time: t_se [s].
        sample_period: T_s [s].
        control_period: T_c [s].
        utilisation_bound: U, 0 < U <= 1.
        tick: Timer tick [s].

    Raises:
        InfeasibleScheduleError: If the load exceeds the bound; the message names both.
    """
    _check(robots, estimation_time, utilisation_bound)
    slack = min(tick, TICK) / 2
    load = utilisation(robots, estimation_time, sample_period + slack, control_period + slack)
    if load > utilisation_bound:
        exact = utilisation(robots, estimation_time, sample_period, control_period)
        raise InfeasibleScheduleError(
            f"periods T_s = {1e3 * sample_period:g} ms and T_c = {1e3 * control_period:g} ms load the processor "
            f"{exact:.4f}, the utilisation bound is {utilisation_bound:g}; "
            f"the shortest common period is {1e3 * period(robots, estimation_time, utilisation_bound):.2f} ms"
        )


@dataclass(frozen=True, kw_only=True)
class ScheduleRow:
    """The period of one estimator of Table II."""

    estimator: str
    t_se_ms: float
    period_exact_ms: float  # Eq. 3
    period_ms: float  # rounded to the timer's tick
    load: float  # of the processor at the rounded period, Eq. 2


def table(
    robots: int, utilisation_bound: float = 1.0, estimation_times: Mapping[str, float] | None = None
) -> list[ScheduleRow]:
    """Returns the shortest common periods of estimators.

    Args:
        robots: Number of robots n, 2 to 7.
        utilisation_bound: U, 0 < U <= 1.
        estimation_times: t_se of each [s]; None: those of Table II.

    Raises:
        InputError: If n or U is outside its range.
        InfeasibleScheduleError: If GPS parsing alone fills the processor.

    Example:
        >>> [(row.estimator, row.period_ms) for row in dy.schedule_table(robots=3)]
        [('gps', 27.0), ('decoupled', 36.0), ('coupled', 156.0)]
    """
    rows = []
    times = estimation_times or {name: figures.estimation_time for name, figures in TABLE_II.items()}
    for estimator, estimation_time in times.items():
        exact = period(robots, estimation_time, utilisation_bound)
        kept = rounded(exact)
        rows.append(
            ScheduleRow(
                estimator=estimator,
                # Behind the ninth digit there is floating-point noise.
                t_se_ms=round(1e3 * estimation_time, 9),
                period_exact_ms=1e3 * exact,
                period_ms=round(1e3 * kept, 9),
                load=utilisation(robots, estimation_time, kept, kept),
            )
        )
    return rows


def rounded(period_s: float, tick: float = TICK) -> float:
    """Returns a period in whole timer ticks [s]: the nearest, as in the paper; of a coarser timer, the next longer."""
    ticks = round(period_s / tick) if tick <= TICK else math.ceil(period_s / tick - 1e-9)
    return max(1, ticks) * tick


def _sampling_time(robots: int, estimation_time: float, tasks: TaskTimes) -> float:
    """Returns the work that every sample brings: t_sd + t_se + t_sb + t_m (n - 1) [s]."""
    return tasks.sensors + estimation_time + tasks.broadcast + tasks.message * (robots - 1)


def _check(robots: int, estimation_time: float, utilisation_bound: float) -> None:
    if not 2 <= robots <= FLEET_SIZE:
        raise InputError(f"{robots} robots given, allowed are 2 to {FLEET_SIZE}")
    if not 0.0 <= estimation_time < float("inf"):
        raise InputError(f"estimation time {estimation_time:g} s given, it must be finite and not negative")
    if not 0.0 < utilisation_bound <= 1.0:
        raise InputError(f"utilisation {utilisation_bound:g} given, allowed is 0 < U <= 1")
