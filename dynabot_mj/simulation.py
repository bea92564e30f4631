"""The one loop: sample, send, deliver, command, advance; for both plants and all trials at once.

The loop walks the merged calendar of sampling and control events, in whole ticks of the processor's timer, and serves
at each event the robots that are due. It cannot tell which plant it drives or which perception it has: that is what
makes the comparison fair.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import numpy.typing as npt

from dynabot_mj import assembly, control_laws, scenario
from dynabot_mj.arrays import Array, BoolArray
from dynabot_mj.controllers.law import Information
from dynabot_mj.error_statistics import ErrorRecorder, ErrorStatistics
from dynabot_mj.metrics import Scores
from dynabot_mj.perception import Belief, certain
from dynabot_mj.plants import FleetState
from dynabot_mj.radio import Heard, Message, Radio
from dynabot_mj.scenario import Case, Scenario
from dynabot_mj.scorer import Scorer, interpolate

TRAJECTORY_INTERVAL = 0.1  # between the recorded positions [s]

Progress = Callable[[float], None]  # told the share of the work that is done


@dataclass(frozen=True, kw_only=True)
class Clocks:
    """When each robot samples and acts, in whole ticks of its processor's timer."""

    sample_ticks: int  # T_s
    control_ticks: int  # T_c
    phase: npt.NDArray[np.int64]  # (n,) first event of each robot's clock; all zero where robots share one

    def events(self, duration_ticks: int) -> Iterator[tuple[int, int]]:
        """Yields the merged calendar: each event's tick, and that of the next one or of the end."""
        due = {
            tick
            for phase in np.unique(self.phase).tolist()
            for period in (self.sample_ticks, self.control_ticks)
            for tick in range(phase, duration_ticks, period)
        }
        calendar = sorted(due | {0})
        yield from zip(calendar, [*calendar[1:], duration_ticks], strict=True)

    def due(self, tick: int, period: int) -> BoolArray:
        """Tells which robots have an event with this period at this tick, (n,)."""
        since = tick - self.phase
        return (since >= 0) & (since % period == 0)


@dataclass(frozen=True, kw_only=True)
class Event:
    """What robots know and do at an event, and until the next one."""

    time: float  # [s]
    belief: Belief
    sent: BoolArray  # (B, n) who broadcasts
    message: Message | None  # what is broadcast; None where nobody samples
    heard: Heard  # as of the latest control event
    force_w: Array  # (B, n, 2) command [N]


class Observer(Protocol):
    """Watches trials without touching them."""

    def event(self, event: Event) -> None:
        """Takes an event, after the robots have decided."""
        ...

    def look(self, state: FleetState) -> None:
        """Takes a state on the way to the next event; the first look is at the start, before any event."""
        ...


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """What is kept of the trials of one case."""

    scores: Scores
    diverged: BoolArray  # (B,)
    hull_contact: Array  # (B,) 1 or 0; NaN for point masses
    wheel_slip: Array  # (B,) largest [m/s]; NaN for point masses
    message_age: Array  # (B,) mean age of the positions acted on [s]; NaN without neighbours heard
    errors: ErrorStatistics  # of what the robots believe
    final_position_w: Array  # (B, n, 2) [m]
    final_heading: Array  # (B, n) [rad]
    time: Array  # (K,) of the trajectory [s]
    trajectory_w: Array  # (R, K, n, 2) of the first R trials [m]


# A trial that blows up may overflow on the way to being reported as diverged; 0 / 0 is "nothing heard".
@np.errstate(over="ignore", invalid="ignore")
def simulate(
    setup: Scenario,
    case: Case,
    trials: Sequence[int],
    *,
    phase: npt.NDArray[np.int64] | None = None,
    recorded: int = 0,
    threads: int = 1,
    progress: Progress = lambda share: None,
    observer: Observer | None = None,
) -> Outcome:
    """Runs trials of one case.

    Args:
        setup: The study's configuration.
        case: Plant, perception and estimator.
        trials: Numbers of the trials, length B; a trial's result depends on its number, not on the others.
        phase: Of each robot's clock, (n,) [ticks]: its first event; None where all share one clock. It is the same in
            all trials, whose calendar would otherwise depend on which of them run together.
        recorded: R, for how many of them the trajectory is kept.
        threads: Of the rigid plant.
        progress: Called now and then.
        observer: Is shown everything; None: nobody watches.
    """
    tick = setup.processor.tick
    sample_ticks, control_ticks = scenario.periods(setup, case.estimator)
    duration_ticks = round(scenario.duration(setup) / tick)
    position_w, heading = assembly.starts(setup, trials)
    if phase is None:
        phase = np.zeros(setup.robots, dtype=np.int64)
    clocks = Clocks(sample_ticks=sample_ticks, control_ticks=control_ticks, phase=phase)
    plant = assembly.plant(setup, case, position_w, heading, trials, threads)
    perception = assembly.perception(setup, case, sample_ticks * tick, trials, plant.state)
    velocity = assembly.velocity(setup, case, plant)
    radio = Radio(scenario.link(setup, case.estimator), setup.robots, setup.seed, trials)
    field = scenario.field(setup, case.estimator)
    law = control_laws.build(setup.controller, field)
    scorer = Scorer(assembly.formation(setup, case, field), assembly.LEADER_W, plant.state, duration_ticks * tick)
    recorder = _Recorder(plant.state, recorded, duration_ticks * tick)
    errors = ErrorRecorder(sample_ticks * tick, heading.shape)
    nobody = np.zeros(heading.shape, dtype=bool)
    belief = replace(certain(position_w, np.zeros_like(position_w)), known=nobody)
    ever_known = nobody
    force_w, heard = np.zeros_like(position_w), radio.heard(np.zeros(heading.shape))
    if observer is not None:
        observer.look(plant.state)
    age_sum, age_count = np.zeros(len(trials)), np.zeros(len(trials))

    for now, then in clocks.events(duration_ticks):
        state, time = plant.state, np.full(heading.shape, now * tick)
        sampling, acting = (
            np.broadcast_to(clocks.due(now, period), heading.shape) for period in (sample_ticks, control_ticks)
        )
        message = None
        if sampling.any():
            fresh = perception.observe(state, sampling)
            if case.perception is not None:
                errors.take(fresh, state, perception.navigation_error(state.time), sampling)
            ever_known = ever_known | (sampling & fresh.known)
            belief = belief.renewed(replace(fresh, velocity_w=velocity(fresh)), sampling)
            message = radio.broadcast(belief.position_w, time, sampling & belief.known)
        if acting.any():
            heard = radio.heard(time)
            age = time[..., None] - heard.sampled_at
            command_w = law(
                Information(
                    time=now * tick,
                    position_w=belief.position_w,
                    velocity_w=belief.velocity_w,
                    leader_w=assembly.LEADER_W,
                    heard_position_w=heard.position_w,
                    heard_known=heard.known,
                    heard_age=age,
                )
            )
            command_w = np.where(belief.known[..., None], command_w, 0.0)
            force_w = np.where(acting[..., None], command_w, force_w)
            used = heard.known & acting[..., None]
            age_sum += np.where(used, age, 0.0).sum(axis=(1, 2))
            age_count += used.sum(axis=(1, 2))
            scorer.control(state)
        if observer is not None:
            sent = sampling & belief.known
            observer.event(
                Event(time=now * tick, belief=belief, sent=sent, message=message, heard=heard, force_w=force_w)
            )
        for look in plant.step(force_w, (then - now) * tick, perception.navigation_error(state.time)):
            perception.look(look)
            scorer.look(look)
            recorder.look(look)
            if observer is not None:
                observer.look(look)
        progress(then / duration_ticks)
    scorer.control(plant.state)
    return Outcome(
        scores=scorer.scores(started=np.all(ever_known, axis=1)),
        diverged=plant.diverged.copy(),
        hull_contact=plant.hull_contact.astype(float),
        wheel_slip=plant.wheel_slip.astype(float),
        message_age=age_sum / age_count,
        errors=errors.statistics(),
        final_position_w=plant.state.position_w,
        final_heading=plant.state.heading,
        time=recorder.times,
        trajectory_w=recorder.trajectory_w,
    )


class _Recorder:
    """Keeps the positions of the first trials on a common grid of times, whatever the plant's own steps."""

    def __init__(self, state: FleetState, recorded: int, duration: float) -> None:
        count = int(duration / TRAJECTORY_INTERVAL + 1e-9) + 1
        self.times = TRAJECTORY_INTERVAL * np.arange(count, dtype=np.float64)
        self.trajectory_w = np.full((recorded, len(self.times), *state.position_w.shape[1:]), np.nan)
        self.trajectory_w[:, 0] = state.position_w[:recorded]
        self._next, self._previous = 1, state

    def look(self, state: FleetState) -> None:
        """Takes a state; those between looks are interpolated linearly."""
        while self._next < len(self.times) and self.times[self._next] <= state.time + 1e-9:
            position_w = interpolate(self._previous, state, self.times[self._next])
            self.trajectory_w[:, self._next] = position_w[: len(self.trajectory_w)]
            self._next += 1
        self._previous = state
