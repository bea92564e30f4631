"""What the radio costs: messages per second, and its share in an event of the loop of point masses.

An event is a sample and a control: each robot broadcasts once, and hears. The radio is run by itself with as many
messages as there are in the loop, in turn with the loop, in CPU time.
"""

import time
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from dynabot_mj.common import tables
from dynabot_mj.common.arrays import Array, Progress
from dynabot_mj.study import assembly, configuration, scenario
from dynabot_mj.study.scenario import Scenario
from dynabot_mj.testbed.paper import RADIO_MAX_ROBOTS
from dynabot_mj.testbed.radio import Radio
from dynabot_mj.trial import loop

_ESTIMATOR = "decoupled"
_TRIALS = 100
_EVENTS = 256  # as many as random numbers are drawn ahead


@dataclass(frozen=True, kw_only=True)
class RadioRow:
    """One number of robots."""

    robots: int
    period_ms: float  # between events
    messages_per_second: float  # of CPU time; each goes to all other robots
    event_us: float  # of the radio, for all trials
    loop_event_us: float  # of the loop
    share: float  # of the radio in the loop's event


def run(repetitions: int, progress: Progress = lambda share: None) -> list[RadioRow]:
    """Measures the radio for every number of robots that it was fitted for.

    Args:
        repetitions: Of each time.
        progress: Told the share of the work that is done.
    """
    setups = [_setup(robots) for robots in range(2, RADIO_MAX_ROBOTS + 1)]
    spent = np.empty((repetitions, len(setups), 2))
    for repetition in range(repetitions):
        for index, setup in enumerate(setups):
            spent[repetition, index] = _radio(setup), _loop(setup)
            progress((repetition + (index + 1) / len(setups)) / repetitions)
    return [_row(setup, spent[:, index]) for index, setup in enumerate(setups)]


def document(rows: list[RadioRow], repetitions: int) -> dict[str, Any]:
    """Returns the JSON document."""
    return {"radio": {"trials": _TRIALS, "repetitions": repetitions, "rows": [asdict(row) for row in rows]}}


def markdown(rows: list[RadioRow], repetitions: int) -> str:
    """Returns the report as a table."""
    body = [
        [
            str(row.robots),
            f"{row.period_ms:.0f}",
            f"{row.messages_per_second:,.0f}",
            f"{row.event_us:.0f}",
            f"{row.loop_event_us:.0f}",
            f"{row.share:.2f}",
        ]
        for row in rows
    ]
    header = ["robots", "T_s [ms]", "messages per CPU-second", "radio [us]", "loop [us]", "share"]
    lines = [
        f"# Cost of the radio, {_TRIALS} trials",
        "",
        *tables.aligned(header, body),
        "",
        "CPU time of an event, in which every robot of every trial sends once and hears; medians of",
        f"{repetitions} repetitions of {_EVENTS} events. Loop: of point masses, estimator {_ESTIMATOR}, gauss-markov.",
        "Share: of the radio in it.",
    ]
    return "\n".join(lines) + "\n"


def _row(setup: Scenario, spent: Array) -> RadioRow:
    """Tells a row from (repetitions, radio and loop) [s]."""
    radio, whole = np.median(spent, axis=0) / _EVENTS
    return RadioRow(
        robots=setup.robots,
        period_ms=1e3 * _period(setup),
        messages_per_second=float(_TRIALS * setup.robots / radio),
        event_us=float(1e6 * radio),
        loop_event_us=float(1e6 * whole),
        share=float(np.median(spent[:, 0] / spent[:, 1])),
    )


def _setup(robots: int) -> Scenario:
    def build(duration: float) -> Scenario:
        return configuration.build({}, plants=["particle"], estimators=[_ESTIMATOR], robots=robots, duration=duration)

    return build(_EVENTS * _period(build(1.0)))


def _period(setup: Scenario) -> float:
    return scenario.periods(setup, _ESTIMATOR)[0] * setup.processor.tick


def _radio(setup: Scenario) -> float:
    """Returns what the radio alone takes [s]."""
    radio = Radio(assembly.link(setup, _ESTIMATOR), setup.robots, setup.seed, range(_TRIALS))
    shape, period = (_TRIALS, setup.robots), _period(setup)
    position_w, due = np.zeros((*shape, 2)), np.ones(shape, dtype=bool)
    begin = time.process_time()
    for event in range(_EVENTS):
        now = np.full(shape, event * period)
        radio.broadcast(position_w, now, due)
        radio.heard(now)
    return time.process_time() - begin


def _loop(setup: Scenario) -> float:
    """Returns what the loop takes, the radio in it [s]."""
    case = scenario.cases(setup)[0]
    parts = assembly.parts(setup, case, range(_TRIALS))
    judge = assembly.judge(setup, case, parts)
    begin = time.process_time()
    loop.simulate(parts, [judge])
    return time.process_time() - begin
