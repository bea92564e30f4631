"""What a consistent filter keeps to: bounds of NEES, NIS and the whiteness of its innovations.

NEES  e^T P^-1 e of the errors e of some states; in the mean their number, if the covariance P is right.
NIS   nu^T S^-1 nu of an innovation; in the mean the number of its components.

Both are chi-square distributed in a consistent filter, so that their mean over R runs at one time lies in the 99 %
bounds chi2(R k) / R in 99 % of the times. Innovations of an optimal filter are white, so the mean of NIS over all
measurements has the same bounds with the number of all of them. Estimation errors are not: the mean of NEES over runs
and times is judged by the spread between the runs (Student's t). Whiteness: autocorrelations of the innovations, each
made unit by the Cholesky factor of S, at lags 1 to 10; of n of them, each lies within 2.58 / sqrt(n) in 99 % of the
cases, and the largest of all of them within Bonferroni's bound.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy import stats

from dynabot_mj.common.arrays import Array
from dynabot_mj.estimation.kalman import Update

CONFIDENCE = 0.99
LAGS = 10
TELLING = 1.5  # times the components: an upper bound beyond it cannot tell a right covariance from a wrong one

Kind = Literal["NEES", "NIS"]


@dataclass(frozen=True, kw_only=True)
class Squares:
    """Normalised squares of errors or innovations."""

    kind: Kind
    of: str
    components: int
    mean: float  # over runs and times
    low: float  # bounds of that
    high: float
    inside: float  # share of the times at which the mean over runs is inside its bounds

    @property
    def verdict(self) -> str:
        """What the mean says of the covariance, or that the bounds are too wide to tell one that is off by half."""
        if self.mean > self.high:
            return "too small"
        if self.mean < self.low:
            return "too large"
        return "consistent" if self.high <= TELLING * self.components else "too few runs to say"


@dataclass(frozen=True, kw_only=True)
class Whiteness:
    """Autocorrelations of innovations at lags 1 to `LAGS`."""

    of: str
    components: int
    samples: int
    largest: float  # of all lags and components, with its sign
    lag: int  # where that is
    bound: float  # of one
    outside: int  # of LAGS * components
    bound_of_all: float

    @property
    def white(self) -> bool:
        """Whether the largest is within the bound of all."""
        return abs(self.largest) <= self.bound_of_all


def nees(of: str, values: Array, components: int) -> Squares:
    """Judges the normalised squares of estimation errors.

    Args:
        of: Which states.
        values: At N times of R runs, (N, R).
        components: Number of the states.
    """
    by_run, runs = values.mean(axis=0), values.shape[1]
    reach = float(stats.t.ppf(0.5 + 0.5 * CONFIDENCE, runs - 1) * by_run.std(ddof=1) / np.sqrt(runs))
    return _squares("NEES", of, values, components, (max(components - reach, 0.0), components + reach))


def nis(of: str, values: Array, components: int) -> Squares:
    """Judges the normalised squares of innovations; see `nees`."""
    return _squares("NIS", of, values, components, bounds(components, values.size))


def whiteness(of: str, innovation: Array) -> Whiteness:
    """Judges the innovations of a measurement, made unit, (N, R, m)."""
    correlation = autocorrelation(innovation)
    samples = innovation.shape[0] * innovation.shape[1]
    bound, bound_of_all = (
        float(stats.norm.isf(0.5 * (1.0 - CONFIDENCE) / tests) / np.sqrt(samples)) for tests in (1, correlation.size)
    )
    worst = np.unravel_index(np.abs(correlation).argmax(), correlation.shape)
    return Whiteness(
        of=of,
        components=innovation.shape[-1],
        samples=samples,
        largest=float(correlation[worst]),
        lag=int(worst[0]) + 1,
        bound=bound,
        outside=int((np.abs(correlation) > bound).sum()),
        bound_of_all=bound_of_all,
    )


def bounds(components: int, count: int) -> tuple[float, float]:
    """Returns between what the mean of some normalised squares lies in a consistent filter.

    Args:
        components: Of each error or innovation.
        count: Of the squares.
    """
    low, high = stats.chi2.ppf([0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE], components * count) / count
    return float(low), float(high)


def unit(update: Update) -> Array:
    """Returns innovations whose components should be independent and of variance 1, (M, m)."""
    factor = np.linalg.cholesky(update.innovation_covariance)
    whitened: Array = np.linalg.solve(factor, update.innovation[..., None])
    return whitened[..., 0]


def autocorrelation(values: Array) -> Array:
    """Returns the autocorrelations of sequences of mean zero, (N, R, m), at lags 1 to `LAGS`, (LAGS, m)."""
    power = (values**2).sum(axis=(0, 1))
    return np.stack([(values[:-lag] * values[lag:]).sum(axis=(0, 1)) / power for lag in range(1, LAGS + 1)])


def _squares(kind: Kind, of: str, values: Array, components: int, of_mean: tuple[float, float]) -> Squares:
    least, most = bounds(components, values.shape[1])
    at_once = values.mean(axis=1)
    return Squares(
        kind=kind,
        of=of,
        components=components,
        mean=float(values.mean()),
        low=of_mean[0],
        high=of_mean[1],
        inside=float(((at_once >= least) & (at_once <= most)).mean()),
    )
