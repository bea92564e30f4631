"""How wrong robots are about themselves in the loop: how large their errors are, and how long they last.

The autocovariance of an error e over a trial of K samples, averaged over robots and axes, is

    C(m) = mean of e_k e_{k+m},        k = 1 .. K - m,

with nothing subtracted: the error's mean over many trials is zero, one trial's is part of the error. C(0) is the mean
square. A sum of Gauss-Markov sequences has C(m) = sum_i sigma_i^2 exp(-m T / tau_i), which `components` fits.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import optimize

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.estimation.gauss_markov import Component
from dynabot_mj.estimation.measurements import wrap
from dynabot_mj.perception.belief import Belief
from dynabot_mj.plants.plant import FleetState, NavigationError

LAGS = (0.0, *(0.03125 * 2.0**k for k in range(11)))  # up to 32 s; each is rounded to a whole sample [s]
MOST_SAMPLES = 20_000  # of each robot, from the beginning: more would not fit the memory, nor tell more
_SMALLEST_SHARE = 0.02  # of the variance, below which a second sequence is not worth it
_BETTER = 0.2  # share of the misfit that it may leave


@dataclass(frozen=True, kw_only=True)
class ErrorStatistics:
    """Autocovariances of the errors of each trial; NaN where there was no error to measure, or clocks differ.

    A robot that does not know where it is has no error; what it does not know is told by `stale`.
    """

    lag: Array  # (B, L) the same in all trials [s]
    position: Array  # (B, L) per axis [m^2]
    velocity: Array  # (B, L) per axis [m^2/s^2]
    heading: Array  # (B, L) [rad^2]
    stale: Array  # (B,) share of the samples whose belief was stale, or that knew nothing
    restarts: Array  # (B,) estimators that broke down and were started again


class ErrorRecorder:
    """Collects the errors of one case's trials."""

    def __init__(self, sample_period: float, shape: tuple[int, ...]) -> None:
        """Starts with none.

        Args:
            sample_period: T_s [s].
            shape: Trials and robots, (B, n).
        """
        self._period, self._shape = sample_period, shape
        self._position: list[npt.NDArray[np.float32]] = []
        self._velocity: list[npt.NDArray[np.float32]] = []
        self._heading: list[npt.NDArray[np.float32]] = []
        self._common_clock = True
        self._stale, self._samples = np.zeros(shape[0]), np.zeros(shape[0])
        self._restarts = np.zeros(shape[0])

    def take(self, fresh: Belief, state: FleetState, error: NavigationError | None, due: BoolArray) -> None:
        """Takes what robots believe at a sample, and the heading's error where local laws have one."""
        self._stale += (due & (fresh.stale | ~fresh.known)).sum(axis=1)
        self._samples += due.sum(axis=1)
        self._restarts = fresh.restarts.sum(axis=1).astype(float)
        self._common_clock &= bool(due.all())
        if not self._common_clock or len(self._position) == MOST_SAMPLES:
            return
        known = np.where(fresh.known, 1.0, np.nan)[..., None]
        # Single precision halves what a long study keeps, and is far finer than what is made of it.
        self._position.append((known * (fresh.position_w - state.position_w)).astype(np.float32))
        self._velocity.append((known * (fresh.velocity_w - state.velocity_w)).astype(np.float32))
        if error is not None:
            self._heading.append((known * wrap(error.heading)[..., None]).astype(np.float32))

    def statistics(self) -> ErrorStatistics:
        """Returns the autocovariances over all that was taken."""
        steps = [round(lag / self._period) for lag in LAGS]
        return ErrorStatistics(
            lag=np.tile(self._period * np.array(steps, dtype=float), (self._shape[0], 1)),
            position=self._autocovariance(self._position, steps),
            velocity=self._autocovariance(self._velocity, steps),
            heading=self._autocovariance(self._heading, steps),
            stale=np.divide(self._stale, self._samples, out=np.full(self._shape[0], np.nan), where=self._samples > 0.0),
            restarts=self._restarts,
        )

    def _autocovariance(self, errors: list[npt.NDArray[np.float32]], steps: Sequence[int]) -> Array:
        found = np.full((self._shape[0], len(steps)), np.nan)
        if not self._common_clock or not errors:
            return found
        series = np.stack(errors, axis=1)  # (B, K, n, axes): a trial's sums must not depend on how many there are
        for trial, own in enumerate(series):
            for index, step in enumerate(steps):
                if step >= len(own):
                    continue
                product = own[: len(own) - step] * own[step:]
                known = np.isfinite(product)
                if known.any():
                    found[trial, index] = np.sum(product, where=known, dtype=float) / known.sum()
        return found


def components(lag: Array, covariance: Array) -> list[Component]:
    """Fits one Gauss-Markov sequence to an autocovariance, or the sum of two where that is a much better fit.

    Args:
        lag: (L,), ascending from zero [s].
        covariance: (L,); NaN where not known.

    Returns:
        The fastest first, together of the error's variance; none where there is no error.
    """
    known = np.isfinite(covariance)
    lag, first = np.unique(lag[known], return_index=True)  # long periods round several lags to one
    covariance = covariance[known][first]
    if not len(lag) or covariance[0] <= 0.0:
        return []
    one, two = (_fit(lag, covariance / covariance[0], count) for count in (1, 2))
    (shares, times), _ = two if two[1] < _BETTER * one[1] and two[0][0].min() > _SMALLEST_SHARE else one
    return [
        Component(deviation=math.sqrt(covariance[0] * share), time=time)
        for time, share in sorted(zip(times.tolist(), shares.tolist(), strict=True))
    ]


def _fit(lag: Array, correlation: Array, count: int) -> tuple[tuple[Array, Array], float]:
    """Returns shares of the variance and correlation times by least squares, and the sum of squares that is left."""

    def sequences(parameters: Array) -> tuple[Array, Array]:
        share = np.concatenate([parameters[count:], [1.0 - parameters[count:].sum()]])
        return share, np.exp(parameters[:count])

    def missed(parameters: Array) -> Array:
        share, time = sequences(parameters)
        modelled: Array = (share * np.exp(-lag[:, None] / time)).sum(axis=-1)
        return modelled - correlation

    bounds = ([math.log(1e-3)] * count + [0.0] * (count - 1), [math.log(1e3)] * count + [1.0] * (count - 1))
    # From several starts, since the problem has more than one valley.
    fits = []
    for fastest in (0.1, 1.0, 8.0):
        start = np.concatenate([np.log(np.geomspace(fastest, 40.0, count)), np.full(count - 1, 0.5)])
        fits.append(optimize.least_squares(missed, start, bounds=bounds))
    best = min(fits, key=lambda fit: float(fit.cost))
    return sequences(best.x), float(best.cost)
