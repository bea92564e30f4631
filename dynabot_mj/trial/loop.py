"""The one loop: sample, send, deliver, command, advance; for both plants and all trials at once.

The loop walks the merged calendar of sampling and control events, in whole ticks of the processor's timer, and serves
at each event the robots that are due. It cannot tell which plant it drives or which perception it has: that is what
makes the comparison fair.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from dynabot_mj.common.arrays import Array, BoolArray, Progress
from dynabot_mj.controllers.law import Information, Law
from dynabot_mj.formation.metrics import Formation, Scores
from dynabot_mj.formation.scorer import Scorer, interpolate
from dynabot_mj.perception.belief import Belief, Perception, certain
from dynabot_mj.perception.error_statistics import ErrorRecorder, ErrorStatistics
from dynabot_mj.plants.plant import FleetState, Plant
from dynabot_mj.testbed.radio import Heard, Message, Radio
from dynabot_mj.trial.clocks import Clocks

TRAJECTORY_INTERVAL = 0.1  # between the recorded positions [s]


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
class Parts:
    """What the trials of one case are made of; B of them, whose numbers the parts' random streams know."""

    clocks: Clocks
    plant: Plant
    perception: Perception
    velocity: Callable[[Belief], Array]  # of the dissipation, (B, n, 2), at a sample [m/s]
    radio: Radio
    law: Law
    leader_w: Array  # (2,) known to every robot exactly and at once [m]
    formation: Formation  # what trials are judged by
    errs: bool  # whether what robots believe differs from the truth


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
    parts: Parts,
    *,
    recorded: int = 0,
    progress: Progress = lambda share: None,
    observer: Observer | None = None,
) -> Outcome:
    """Runs trials of one case.

    Args:
        parts: What they are made of.
        recorded: R, for how many of them the trajectory is kept.
        progress: Called now and then.
        observer: Is shown everything; None: nobody watches.
    """
    clocks, plant, perception, radio = parts.clocks, parts.plant, parts.perception, parts.radio
    start = plant.state
    scorer = Scorer(parts.formation, parts.leader_w, start, clocks.duration)
    recorder = _Recorder(start, recorded, clocks.duration)
    errors = ErrorRecorder(clocks.sample_period, start.heading.shape)
    nobody = np.zeros(start.heading.shape, dtype=bool)
    belief = replace(certain(start.position_w, np.zeros_like(start.position_w)), known=nobody)
    ever_known = nobody
    force_w, heard = np.zeros_like(start.position_w), radio.heard(np.zeros(start.heading.shape))
    if observer is not None:
        observer.look(start)
    age_sum, age_count = np.zeros(len(nobody)), np.zeros(len(nobody))

    for now, then in clocks.events():
        state, time = plant.state, np.full(nobody.shape, now * clocks.tick)
        sampling, acting = (
            np.broadcast_to(clocks.due(now, period), nobody.shape)
            for period in (clocks.sample_ticks, clocks.control_ticks)
        )
        message = None
        if sampling.any():
            fresh = perception.observe(state, sampling)
            if parts.errs:
                errors.take(fresh, state, perception.navigation_error(state.time), sampling)
            ever_known = ever_known | (sampling & fresh.known)
            belief = belief.renewed(replace(fresh, velocity_w=parts.velocity(fresh)), sampling)
            message = radio.broadcast(belief.position_w, time, sampling & belief.known)
        if acting.any():
            heard = radio.heard(time)
            age = time[..., None] - heard.sampled_at
            command_w = parts.law(
                Information(
                    time=now * clocks.tick,
                    position_w=belief.position_w,
                    velocity_w=belief.velocity_w,
                    leader_w=parts.leader_w,
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
                Event(time=now * clocks.tick, belief=belief, sent=sent, message=message, heard=heard, force_w=force_w)
            )
        for look in plant.step(force_w, (then - now) * clocks.tick, perception.navigation_error(state.time)):
            perception.look(look)
            scorer.look(look)
            recorder.look(look)
            if observer is not None:
                observer.look(look)
        progress(then / clocks.duration_ticks)
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
