"""What the study's loop costs: rigid bodies against the raw engine, and how many point masses it serves.

A rigid run is driven once, its motors' commands are kept, and then it is driven again, in turn with the engine that
repeats them: every few control periods, so that what else the machine does falls on both alike. The same seed drives
the same run, so that the engine does just the same physics. An env-step is one control period of all robots of one
trial. All is CPU time, but for the wall's ratio, which tells what a second thread is worth.
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dynabot_mj.common.arrays import Array, Progress
from dynabot_mj.experiments.formation.stages import shares
from dynabot_mj.plants.plant import FleetState
from dynabot_mj.plants.replay import Engine, Recording
from dynabot_mj.plants.rigid_body import RigidBodyPlant
from dynabot_mj.study import assembly, configuration, scenario
from dynabot_mj.study.scenario import Case, PerceptionName, Scenario
from dynabot_mj.trial import loop
from dynabot_mj.trial.judge import Judge
from dynabot_mj.trial.loop import Event, Parts

ESTIMATOR = "decoupled"
HEADLINE: tuple[PerceptionName, int, int] = ("gauss-markov", 100, 1)  # perception, trials, threads
_PERCEPTIONS: tuple[PerceptionName, ...] = ("gauss-markov", "filter")
_RIGID_TRIALS, _THREADS = (1, 10, 100), (1, 2)
_PARTICLE_TRIALS = (1, 100, 1000, 10_000)
_SHARED_TRIALS = {"particle": 1000, "rigid": 100}  # of which shares are told
# Random numbers are drawn 256 events ahead: fewer would be charged for numbers that nobody uses. Of bodies they cost
# next to nothing, and as many events would take minutes.
_EVENTS = {"particle": 256, "rigid": 80}
_TURN = 32  # events of a trial, of loop or engine at once: so few of one trial that both stay in the cache


@dataclass(frozen=True, kw_only=True)
class RigidRow:
    """The loop of rigid robots beside the engine; CPU time per env-step."""

    perception: PerceptionName
    trials: int
    threads: int
    loop_us: float
    raw_us: float
    overhead_ratio: float  # loop over raw
    wall_ratio: float  # the same of wall time


@dataclass(frozen=True, kw_only=True)
class ParticleRow:
    """The loop of point masses."""

    trials: int
    env_steps_per_second: float  # of CPU time


@dataclass(frozen=True, kw_only=True)
class ShareRow:
    """Where the loop's time goes."""

    plant: str
    perception: PerceptionName
    trials: int
    shares: dict[str, float]  # by stage, see `stages.STAGES`


@dataclass(frozen=True, kw_only=True)
class LoopReport:
    """What was measured."""

    robots: int
    repetitions: int
    control_period_ms: float
    seconds: dict[str, float]  # of each plant's trials [s]
    rigid: tuple[RigidRow, ...]
    particle: tuple[ParticleRow, ...]
    shares: tuple[ShareRow, ...]

    @property
    def overhead_ratio(self) -> float:
        """That of `HEADLINE`."""
        return next(row.overhead_ratio for row in self.rigid if (row.perception, row.trials, row.threads) == HEADLINE)


def run(robots: int, repetitions: int, progress: Progress = lambda share: None) -> LoopReport:
    """Measures the loop.

    Args:
        robots: In each trial, 2 to 7.
        repetitions: Of each time.
        progress: Told the share of the work that is done.

    Raises:
        InputError: If there are not so many robots.
    """
    measures: list[tuple[str, PerceptionName, int, int]] = [
        ("rigid", perception, trials, threads)
        for perception in _PERCEPTIONS
        for trials in _RIGID_TRIALS
        for threads in _THREADS
    ]
    measures += [("particle", HEADLINE[0], trials, 1) for trials in _PARTICLE_TRIALS]
    recordings = {key: _recorded(robots, *key) for key in {key[1:3] for key in measures if key[0] == "rigid"}}
    progress(0.1)
    spent: dict[tuple[str, PerceptionName, int, int], list[Array]] = {key: [] for key in measures}
    # The repetitions are the outer ones: a slow minute of the machine does not fall on one row.
    for repetition in range(repetitions):
        for done, key in enumerate(measures):
            plant, perception, trials, threads = key
            spent[key].append(
                _alternated(robots, perception, trials, threads, recordings[perception, trials])
                if plant == "rigid"
                else _alone(robots, perception, trials)
            )
            progress(0.1 + 0.8 * (repetition + (done + 1) / len(measures)) / repetitions)
    return LoopReport(
        robots=robots,
        repetitions=repetitions,
        control_period_ms=1e3 * _period(_setup(robots, "rigid", HEADLINE[0])),
        seconds={plant: scenario.duration(_setup(robots, plant, HEADLINE[0])) for plant in _EVENTS},
        rigid=tuple(_rigid_row(*key[1:], np.array(spent[key])) for key in measures if key[0] == "rigid"),
        particle=tuple(
            ParticleRow(
                trials=key[2],
                env_steps_per_second=float(_EVENTS["particle"] * key[2] / np.median(spent[key])),
            )
            for key in measures
            if key[0] == "particle"
        ),
        shares=tuple(_share_row(robots, plant, perception) for plant in _EVENTS for perception in _PERCEPTIONS),
    )


def _rigid_row(perception: PerceptionName, trials: int, threads: int, spent: Array) -> RigidRow:
    """Tells a row from (repetitions, loop and raw, CPU and wall) [s]."""
    cpu_us = 1e6 * np.median(spent[..., 0], axis=0) / (_EVENTS["rigid"] * trials)
    ratios = np.median(spent[:, 0] / spent[:, 1], axis=0)
    return RigidRow(
        perception=perception,
        trials=trials,
        threads=threads,
        loop_us=float(cpu_us[0]),
        raw_us=float(cpu_us[1]),
        overhead_ratio=float(ratios[0]),
        wall_ratio=float(ratios[1]),
    )


def _share_row(robots: int, plant: str, perception: PerceptionName) -> ShareRow:
    setup, trials = _setup(robots, plant, perception), _SHARED_TRIALS[plant]
    case = _case(setup)
    parts = assembly.parts(setup, case, range(trials))
    return ShareRow(
        plant=plant,
        perception=perception,
        trials=trials,
        shares=shares(parts, assembly.judge(setup, case, parts)),
    )


def _setup(robots: int, plant: str, perception: PerceptionName) -> Scenario:
    def build(duration: float) -> Scenario:
        return configuration.build(
            {}, plants=[plant], estimators=[ESTIMATOR], perception=[perception], robots=robots, duration=duration
        )

    return build(_EVENTS[plant] * _period(build(1.0)))


def _period(setup: Scenario) -> float:
    """Returns T_c, which is T_s, [s]."""
    return scenario.periods(setup, ESTIMATOR)[1] * setup.processor.tick


def _case(setup: Scenario) -> Case:
    return scenario.cases(setup)[0]


def _recorded(robots: int, perception: PerceptionName, trials: int) -> Recording:
    """Drives rigid robots and keeps their commands."""
    setup = _setup(robots, "rigid", perception)
    parts = assembly.parts(setup, _case(setup), range(trials))
    assert isinstance(parts.plant, RigidBodyPlant)
    recording = parts.plant.record()
    loop.simulate(parts)
    return recording


def _alone(robots: int, perception: PerceptionName, trials: int) -> Array:
    """Returns what the loop of point masses takes [s]."""
    setup = _setup(robots, "particle", perception)
    case = _case(setup)
    parts = assembly.parts(setup, case, range(trials))
    judge = assembly.judge(setup, case, parts)
    begin = time.process_time()
    loop.simulate(parts, [judge])
    return np.array(time.process_time() - begin)


def _alternated(robots: int, perception: PerceptionName, trials: int, threads: int, recording: Recording) -> Array:
    """Returns what loop and engine take in turn, (loop and raw, CPU and wall) [s]."""
    setup = _setup(robots, "rigid", perception)
    case = _case(setup)
    parts = assembly.parts(setup, case, range(trials), threads=threads)
    engine = Engine(recording, threads)
    commands = len(recording.commands) // _EVENTS["rigid"]  # of an event
    judge = assembly.judge(setup, case, parts)
    return in_turn(parts, judge, lambda events: engine.run(events * commands), math.ceil(_TURN / trials))


def in_turn(parts: Parts, judge: Judge, follow: Callable[[int], None], turn: int) -> Array:
    """Returns what the loop and what follows it take, (2, CPU and wall) [s].

    Args:
        parts: What the trials are made of.
        judge: Of them.
        follow: Does what the loop did in so many control periods.
        turn: How many, the last time fewer.
    """
    turns = _Turns(follow, turn)
    loop.simulate(parts, [judge, turns])
    turns.hand_over()
    return turns.spent


class _Turns:
    """An observer that has another follow the loop."""

    def __init__(self, follow: Callable[[int], None], turn: int) -> None:
        """Starts the loop's clocks; see `in_turn`."""
        self.spent = np.zeros((2, 2))
        self._follow, self._turn, self._waiting = follow, turn, 0
        self._since = _now()

    def event(self, event: Event) -> None:
        """Takes the end of a control period, and the beginning of the next."""
        if self._waiting == self._turn:
            self.hand_over()
        self._waiting += 1

    def substep(self, state: FleetState) -> None:
        """Takes a state, of which nothing is kept."""

    def hand_over(self) -> None:
        """Stops the loop's clocks while the other follows."""
        begin = _now()
        self._follow(self._waiting)
        end = _now()
        self.spent += [begin - self._since, end - begin]
        self._waiting, self._since = 0, end


def _now() -> Array:
    """Returns CPU and wall time [s]."""
    return np.array([time.process_time(), time.perf_counter()])
