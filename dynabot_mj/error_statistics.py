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

from dynabot_mj.arrays import Array, BoolArray
from dynabot_mj.perception import Belief
from dynabot_mj.plants import FleetState, NavigationError
from estimation.gauss_markov import Component
from estimation.measurements import wrap

LAGS = (0.0, *(0.03125 * 2.0**k for k in range(11)))  # up to 32 s; each is rounded to a whole sample [s]
_SMALLEST_SHARE = 0.02  # of the variance, below which a second sequence is not worth it
_BETTER = 0.2  # share of the misfit that it may leave


@dataclass(frozen=True, kw_only=True)
class ErrorStatistics:
    """Autocovariances of the errors of each trial; NaN where there was no error to measure, or clocks differ."""

    lag: Array  # (B, L) the same in all trials [s]
    position: Array  # (B, L) per axis [m^2]
    velocity: Array  # (B, L) per axis [m^2/s^2]
    heading: Array  # (B, L) [rad^2]


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

    def take(self, fresh: Belief, state: FleetState, error: NavigationError | None, due: BoolArray) -> None:
        """Takes what robots believe at a sample, and the heading's error where local laws have one."""
        self._common_clock &= bool(due.all())
        if not self._common_clock:
            return
        # Single precision halves what a long study keeps, and is far finer than what is made of it.
        self._position.append((fresh.position_w - state.position_w).astype(np.float32))
        self._velocity.append((fresh.velocity_w - state.velocity_w).astype(np.float32))
        if error is not None:
            self._heading.append(wrap(error.heading).astype(np.float32)[..., None])

    def statistics(self) -> ErrorStatistics:
        """Returns the autocovariances over all that was taken."""
        steps = [round(lag / self._period) for lag in LAGS]
        return ErrorStatistics(
            lag=np.tile(self._period * np.array(steps, dtype=float), (self._shape[0], 1)),
            position=self._autocovariance(self._position, steps),
            velocity=self._autocovariance(self._velocity, steps),
            heading=self._autocovariance(self._heading, steps),
        )

    def _autocovariance(self, errors: list[npt.NDArray[np.float32]], steps: Sequence[int]) -> Array:
        found = np.full((self._shape[0], len(steps)), np.nan)
        if not self._common_clock or not errors:
            return found
        series = np.stack(errors)  # (K, B, n, axes)
        for index, step in enumerate(steps):
            if step < len(series):
                product = series[: len(series) - step] * series[step:]
                found[:, index] = product.mean(axis=(0, 2, 3), dtype=float)
        return found


def components(lag: Array, covariance: Array) -> list[Component]:
    """Fits one Gauss-Markov sequence to an autocovariance, or the sum of two where that is a much better fit.

    Args:
        lag: (L,), ascending from zero [s].
        covariance: (L,); NaN where not known.

    Returns:
        The fastest first; none where there is no error.
    """
    known = np.isfinite(covariance)
    lag, covariance = lag[known], covariance[known]
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

    def missed(logarithms: Array) -> Array:
        share, time = np.exp(logarithms).reshape(2, count)
        modelled: Array = (share * np.exp(-lag[:, None] / time)).sum(axis=-1)
        return modelled - correlation

    low, high = [-9.0] * count + [math.log(1e-3)] * count, [0.5] * count + [math.log(1e3)] * count
    # From several starts, since the problem has more than one valley.
    starts = [
        [-math.log(count)] * count + np.log(np.geomspace(first, 40.0, count)).tolist() for first in (0.1, 1.0, 8.0)
    ]
    fits = [optimize.least_squares(missed, start, bounds=(low, high)) for start in starts]
    best = min(fits, key=lambda fit: float(fit.cost))
    shares, times = np.exp(best.x).reshape(2, count)
    return (shares, times), float(best.cost)
