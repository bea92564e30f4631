"""What is kept of trials: their scores, what the robots' beliefs were worth, and where the first of them drove."""

from dataclasses import dataclass

import numpy as np

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.formation.metrics import Formation
from dynabot_mj.formation.scorer import Scorer, Scores, interpolate
from dynabot_mj.perception.error_statistics import ErrorRecorder, ErrorStatistics
from dynabot_mj.plants.plant import FleetState, WheeledPlant
from dynabot_mj.trial.loop import Event, Parts

TRAJECTORY_INTERVAL = 0.1  # between the recorded positions [s]


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


class Judge:
    """Observes trials and tells their outcome."""

    def __init__(self, parts: Parts, formation: Formation, *, errs: bool, recorded: int = 0) -> None:
        """Has seen nothing yet.

        Args:
            parts: Of the trials that it will observe.
            formation: What they are judged by.
            errs: Whether what robots believe differs from the truth, so that its errors are worth keeping.
            recorded: R, for how many of the trials the trajectory is kept.
        """
        clocks, start = parts.clocks, parts.plant.state
        shape = start.heading.shape
        self.scorer = Scorer(formation, parts.leader_w, shape, clocks.duration)
        self._plant, self._errs = parts.plant, errs
        self._trajectory = _Trajectory(start, recorded, clocks.duration)
        self._errors = ErrorRecorder(clocks.sample_period, shape)
        self._ever_known = np.zeros(shape, dtype=bool)
        self._age_sum, self._age_count = np.zeros(shape[0]), np.zeros(shape[0])

    def event(self, event: Event) -> None:
        """Takes what the robots believe and act on."""
        if event.sample is not None:
            told = event.sample.told
            if self._errs:
                self._errors.take(told, event.state, event.error, event.sampling)
            self._ever_known = self._ever_known | (event.sampling & told.known)
        if event.information is not None:
            used = event.information.heard_known & event.acting[..., None]
            self._age_sum += np.where(used, event.information.heard_age, 0.0).sum(axis=(1, 2))
            self._age_count += used.sum(axis=(1, 2))
            self.scorer.control(event.state)

    def substep(self, state: FleetState) -> None:
        """Takes where the robots are."""
        self.scorer.substep(state)
        self._trajectory.substep(state)

    @np.errstate(over="ignore", invalid="ignore")  # as in the loop: of trials that have blown up
    def outcome(self) -> Outcome:
        """Returns the outcome, after the last state."""
        plant = self._plant
        nothing = np.full(len(self._age_sum), np.nan)
        wheeled = plant if isinstance(plant, WheeledPlant) else None
        return Outcome(
            scores=self.scorer.scores(started=np.all(self._ever_known, axis=1)),
            diverged=plant.diverged.copy(),
            hull_contact=nothing if wheeled is None else wheeled.hull_contact.astype(float),
            wheel_slip=nothing if wheeled is None else wheeled.wheel_slip.copy(),
            message_age=np.divide(self._age_sum, self._age_count, out=nothing.copy(), where=self._age_count > 0.0),
            errors=self._errors.statistics(),
            final_position_w=plant.state.position_w,
            final_heading=plant.state.heading,
            time=self._trajectory.times,
            trajectory_w=self._trajectory.position_w,
        )


class _Trajectory:
    """Keeps the positions of the first trials on a common grid of times, whatever the plant's own steps."""

    def __init__(self, start: FleetState, recorded: int, duration: float) -> None:
        count = int(duration / TRAJECTORY_INTERVAL + 1e-9) + 1
        self.times = TRAJECTORY_INTERVAL * np.arange(count, dtype=np.float64)
        self.position_w = np.full((recorded, len(self.times), *start.position_w.shape[1:]), np.nan)
        self._next, self._previous = 0, start

    def substep(self, state: FleetState) -> None:
        """Takes a state; those between two are interpolated linearly."""
        while self._next < len(self.times) and self.times[self._next] <= state.time + 1e-9:
            position_w = interpolate(self._previous, state, self.times[self._next])
            self.position_w[:, self._next] = position_w[: len(self.position_w)]
            self._next += 1
        self._previous = state
