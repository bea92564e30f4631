"""Intervals: Wilson for rates, the percentile bootstrap for paired differences. All are 95 %."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import stats

from dynabot_mj.arrays import Array

CONFIDENCE = 0.95
RESAMPLES = 10_000


@dataclass(frozen=True, kw_only=True)
class Rate:
    """A share of trials with its Wilson interval; None where no trial counts."""

    rate: float | None
    low: float | None
    high: float | None
    k: int
    n: int


@dataclass(frozen=True, kw_only=True)
class Mean:
    """A mean with its standard deviation (ddof 1); None where there are too few values."""

    mean: float | None
    sd: float | None
    n: int


@dataclass(frozen=True, kw_only=True)
class Difference:
    """A mean paired difference with its bootstrap interval; None where there are too few pairs."""

    difference: float | None
    low: float | None
    high: float | None
    n: int


def rate(values: npt.ArrayLike) -> Rate:
    """Returns the share of ones.

    Args:
        values: Zeros and ones, any length; NaN does not count.
    """
    counted = _finite(values)
    return share(int(counted.sum()), len(counted))


def share(k: int, n: int) -> Rate:
    """Returns k of n with its Wilson interval."""
    if n == 0:
        return Rate(rate=None, low=None, high=None, k=0, n=0)
    interval = stats.binomtest(k, n).proportion_ci(CONFIDENCE, method="wilson")
    return Rate(rate=k / n, low=float(interval.low), high=float(interval.high), k=k, n=n)


def mean(values: npt.ArrayLike) -> Mean:
    """Returns mean and standard deviation of the values that are not NaN."""
    counted = _finite(values)
    n = len(counted)
    return Mean(mean=float(counted.mean()) if n else None, sd=float(counted.std(ddof=1)) if n > 1 else None, n=n)


def paired_difference(a: npt.ArrayLike, b: npt.ArrayLike, seed: int = 0) -> Difference:
    """Returns the mean of a - b over the trials where both have a value.

    Args:
        a: One value per trial.
        b: The same trials under another condition.
        seed: Of the bootstrap.
    """
    difference = _finite(np.asarray(a, dtype=float) - np.asarray(b, dtype=float))
    n = len(difference)
    if n < 2:
        return Difference(difference=float(difference[0]) if n else None, low=None, high=None, n=n)
    interval = stats.bootstrap(
        (difference,),
        np.mean,
        n_resamples=RESAMPLES,
        confidence_level=CONFIDENCE,
        method="percentile",
        batch=1000,
        rng=np.random.default_rng(seed),
    ).confidence_interval
    return Difference(difference=float(difference.mean()), low=float(interval.low), high=float(interval.high), n=n)


def _finite(values: npt.ArrayLike) -> Array:
    array = np.asarray(values, dtype=float)
    return array[np.isfinite(array)]
