"""What estimates along recorded drives are judged by, each run for itself.

uncertainty         largest distance of the estimated path from the best-fit actual one: the paper's figure (Table II)
true error          largest distance of an estimate from the truth of the same time
RMS                 over time and both axes; again without each axis's mean, which the best fit does not see either
NEES                (x - x_true)^T P^-1 (x - x_true) over the ten states, mean over time; 10 of a consistent filter
NIS                 normalised innovation squared of a fix, summed over its updates, mean over the fixes; 4
"""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from dynabot_mj.common.arrays import Array, rms
from dynabot_mj.estimation import motion
from dynabot_mj.estimation.estimator import Estimator
from dynabot_mj.estimation.measurements import rotation, wrap
from dynabot_mj.experiments.estimators import best_fit
from dynabot_mj.experiments.estimators.best_fit import BestFit
from dynabot_mj.experiments.estimators.kinematic import PathName
from dynabot_mj.sensing.ground_truth import GroundTruth
from dynabot_mj.sensing.replay import Samples, Track


@runtime_checkable
class FullState(Protocol):
    """A filter of all ten states."""

    def moments(self) -> tuple[Array, Array]:
        """Returns x, (M, 10), and P, (M, 10, 10)."""
        ...


@dataclass(frozen=True, kw_only=True)
class EstimationScores:
    """Of R runs; NaN for a run whose estimator did not know where it was throughout."""

    uncertainty: Array  # (R,) [m]
    true_error: Array  # (R,) [m]
    rms: Array  # (R,) per axis [m]
    rms_mean_removed: Array  # (R,) per axis [m]
    heading_rms: Array  # (R,) [rad]
    nees: Array  # (R,); NaN of an estimator that has no ten states
    nis: Array  # (R,); NaN where no fix came


class Consistency:
    """Collects NEES and NIS while an estimator follows samples: give `collect` to `replay.follow`."""

    def __init__(self, estimator: Estimator, state: Array, first: int) -> None:
        """Starts with no sample.

        Args:
            estimator: That follows.
            state: True ten states at each sample, (N, R, 10).
            first: Index of the first sample that counts.
        """
        runs = state.shape[1]
        self._estimator, self._state, self._first = estimator, state, first
        self._nees, self._samples = np.zeros(runs), 0
        self._nis, self._fixes = np.zeros(runs), np.zeros(runs)

    def collect(self, index: int) -> None:
        """Takes what the estimator believes after a sample."""
        if index < self._first:
            return
        if isinstance(self._estimator.filter, FullState):
            state, covariance = self._estimator.filter.moments()
            # One whose numbers broke down waits for its next fix, and its run gets no score.
            covariance = np.where(self._estimator.filter.sound()[:, None, None], covariance, np.eye(motion.STATES))
            self._nees += nees(less(state, self._state[index]), covariance)
            self._samples += 1
        rows, updates = self._estimator.fix_updates
        for update in updates:
            self._nis[rows] += update.squared
        self._fixes[rows] += 1

    @property
    def nees(self) -> Array:
        """Mean over the samples, (R,)."""
        return self._nees / self._samples if self._samples else np.full_like(self._nees, np.nan)

    @property
    def nis(self) -> Array:
        """Mean over the fixes, (R,)."""
        return np.where(self._fixes > 0, self._nis / np.maximum(self._fixes, 1), np.nan)


def ten_states(truth: GroundTruth, samples: Samples) -> Array:
    """Returns what the filters estimate as it truly is, (N, R, 10).

    Args:
        truth: At N times.
        samples: Of the same times, simulated: their true errors are the biases.
    """
    assert samples.errors is not None
    velocity_b = motion.turned(rotation(-truth.heading), truth.velocity_w)
    return np.concatenate([truth.position_w, velocity_b, truth.heading[..., None], samples.errors], axis=-1)


def less(state: Array, truth: Array) -> Array:
    """Returns the errors of ten states, (R, 10) each, that of the heading wrapped."""
    error: Array = state - truth
    error[:, motion.HEADING] = wrap(error[:, motion.HEADING])
    return error


def nees(error: Array, covariance: Array) -> Array:
    """Returns the normalised squares of errors, (R,), from (R, s) and (R, s, s)."""
    return (error[:, None] @ np.linalg.solve(covariance, error[..., None]))[:, 0, 0]


def judge(
    path: PathName, track: Track, truth: GroundTruth, consistency: Consistency, first: int
) -> tuple[EstimationScores, BestFit]:
    """Judges an estimator's track.

    Args:
        path: Shape of the actual one.
        track: What it believed at N times.
        truth: At the same times.
        consistency: What was collected on the way.
        first: Index of the first sample that counts.

    Returns:
        The scores, and the best fits from that sample on.
    """
    known, true_w = track.known[first:], truth.position_w[first:]
    # What is not known need not be a number; the run gets no score, but must not disturb the others'.
    estimate_w = np.where(known[..., None], track.position_w[first:], true_w)
    fitted = best_fit.fit(path, estimate_w, true_w)
    error_w = estimate_w - true_w
    turned = wrap(np.where(known, track.heading[first:] - truth.heading[first:], 0.0))

    def score(values: Array) -> Array:
        return np.where(known.all(axis=0), values, np.nan)

    scores = EstimationScores(
        uncertainty=score(fitted.distance.max(axis=0)),
        true_error=score(np.linalg.norm(error_w, axis=-1).max(axis=0)),
        rms=score(rms(error_w, axis=(0, 2))),
        rms_mean_removed=score(rms(error_w - error_w.mean(axis=0), axis=(0, 2))),
        heading_rms=score(rms(turned[..., None], axis=(0, 2))),
        nees=score(consistency.nees),
        nis=score(consistency.nis),
    )
    return scores, fitted
