"""Intervals and tests, 95 % throughout: what a sample allows to say, and no more.

rate          Wilson's score interval.
mean          mean and standard deviation; `bootstrapped` adds the BCa bootstrap interval of Efron (1987), which holds
              too seldom where a few trials are far from all others, and below six values far too seldom: none then.
median        with the exact, distribution-free interval of two order statistics: what stands beside such a mean. Of
              values that are known to lie between bounds only, it is as open as they are.
hazard        events over time at risk, with the exact interval of a Poisson count.
paired means  BCa interval of the mean difference and a permutation test, in which each pair's difference changes its
              sign: the same trials under two conditions are exchangeable where the conditions do not matter.
paired rates  McNemar's exact test, and the score interval of Tango (1998), which holds at rates near 0 and 1. Where
              the exact conditional interval of the discordant pairs reaches farther, the interval does too: so it
              includes zero wherever the exact test does not reject, as at 5 discordant pairs of 5 on one side.
many          beyond `MANY` values, both by the normal law that they tend to.
Holm (1979)   adjusts the p values of one family, so that all rejections together are wrong in 5 % of the cases.
equivalence   two one-sided tests at 5 %: the 90 % interval lies within a margin that was stated before.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import optimize, stats
from statsmodels.stats import multitest, rates

from dynabot_mj.common.arrays import Array

CONFIDENCE = 0.95
RESAMPLES = 10_000
# Values from which on the normal law takes the place of resampling, whose time and memory grow with them: for times
# whose skewness is 3 the ends of the two intervals differ by less than a twentieth of their width.
MANY = 5_000
_FEWEST = 6  # values that a bootstrap interval is given of


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
class MeanInterval:
    """A mean with its BCa interval; None where there are too few values."""

    mean: float | None
    low: float | None
    high: float | None


@dataclass(frozen=True, kw_only=True)
class Median:
    """A median with its exact interval; None where there are too few values."""

    median: float | None
    low: float | None
    high: float | None


@dataclass(frozen=True, kw_only=True)
class Hazard:
    """Events over time at risk [1/min]; None where nobody was at risk."""

    rate: float | None
    low: float | None
    high: float | None
    k: int
    minutes: float  # at risk


@dataclass(frozen=True, kw_only=True)
class Difference:
    """A mean paired difference with its interval and the p value of no difference; None where there are too few."""

    difference: float | None
    low: float | None
    high: float | None
    n: int
    p: float | None
    median: Median | None = None  # of the differences; None for rates


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


def bootstrapped(values: npt.ArrayLike, seed: int = 0, confidence: float = CONFIDENCE) -> MeanInterval:
    """Returns the mean of the values that are not NaN with its BCa interval.

    Args:
        values: Any length.
        seed: Of the bootstrap.
        confidence: Of the interval.
    """
    counted = _finite(values)
    if len(counted) == 0:
        return MeanInterval(mean=None, low=None, high=None)
    middle = float(counted.mean())
    if len(counted) < _FEWEST:
        return MeanInterval(mean=middle, low=None, high=None)
    if constant(counted):  # there is nothing to resample
        return MeanInterval(mean=middle, low=middle, high=middle)
    if len(counted) > MANY:
        half = float(stats.norm.ppf(0.5 * (1.0 + confidence)) * counted.std(ddof=1) / np.sqrt(len(counted)))
        return MeanInterval(mean=middle, low=middle - half, high=middle + half)
    interval = stats.bootstrap(
        (counted,),
        np.mean,
        n_resamples=RESAMPLES,
        confidence_level=confidence,
        method="BCa",
        batch=1000,
        rng=np.random.default_rng(seed),
    ).confidence_interval
    return MeanInterval(mean=middle, low=float(interval.low), high=float(interval.high))


def median(values: npt.ArrayLike) -> Median:
    """Returns the median of the values that are not NaN.

    The k-th smallest and the k-th largest of n values hold the median between them with the probability that at least k
    and at most n - k of n fair coins show heads.
    """
    ordered = np.sort(_finite(values))
    return median_between(ordered, ordered)


def median_between(least: npt.ArrayLike, most: npt.ArrayLike) -> Median:
    """Returns the median of values that are known to lie between bounds; None where those leave it open.

    Args:
        least: What each is at least; -inf: nothing is known.
        most: What each is at most; inf: nothing is known.
    """
    lower, upper = np.sort(np.asarray(least, dtype=float)), np.sort(np.asarray(most, dtype=float))
    n = len(lower)
    if n == 0:
        return Median(median=None, low=None, high=None)
    k = int(stats.binom.ppf(0.5 * (1.0 - CONFIDENCE), n, 0.5))
    low, high = (lower[k - 1], upper[n - k]) if k else (-np.inf, np.inf)
    middle = slice((n - 1) // 2, n // 2 + 1)
    known = np.isfinite(lower[middle]).all() and (lower[middle] == upper[middle]).all()
    return Median(
        median=float(lower[middle].mean()) if known else None,
        low=float(low) if np.isfinite(low) else None,
        high=float(high) if np.isfinite(high) else None,
    )


def hazard(k: int, minutes: float) -> Hazard:
    """Returns the rate of k events in a time at risk [min] with the exact interval of a Poisson count."""
    if minutes <= 0.0:
        return Hazard(rate=None, low=None, high=None, k=k, minutes=0.0)
    low, high = rates.confint_poisson(k, minutes, method="exact-c", alpha=1.0 - CONFIDENCE)
    return Hazard(rate=k / minutes, low=float(low), high=float(high), k=k, minutes=minutes)


def paired_difference(
    a: npt.ArrayLike, b: npt.ArrayLike, seed: int = 0, confidence: float = CONFIDENCE, *, tested: bool = True
) -> Difference:
    """Returns the mean of a - b over the trials where both have a value.

    Args:
        a: One value per trial.
        b: The same trials under another condition.
        seed: Of bootstrap and permutations.
        confidence: Of the interval.
        tested: Whether a p value is wanted.
    """
    difference = _finite(np.asarray(a, dtype=float) - np.asarray(b, dtype=float))
    n = len(difference)
    interval = bootstrapped(difference, seed, confidence)
    p = None
    if tested and n > MANY:
        spread = math.sqrt((difference**2).sum())  # of the sum, where each difference may have either sign
        p = float(2.0 * stats.norm.sf(abs(difference.sum()) / spread)) if spread > 0.0 else 1.0
    elif tested and n > 1:
        test = stats.permutation_test(
            (difference,),
            np.mean,
            permutation_type="samples",
            n_resamples=RESAMPLES - 1,
            batch=1000,
            rng=np.random.default_rng(seed),
        )
        p = float(test.pvalue)
    low, high = interval.low, interval.high
    return Difference(difference=interval.mean, low=low, high=high, n=n, p=p, median=median(difference))


def paired_rates(a: npt.ArrayLike, b: npt.ArrayLike, confidence: float = CONFIDENCE) -> Difference:
    """Returns the difference of two rates, a - b, over the trials where both have a value.

    Args:
        a: Zeros and ones, one per trial; NaN does not count.
        b: The same trials under another condition.
        confidence: Of the interval.
    """
    difference = _finite(np.asarray(a, dtype=float) - np.asarray(b, dtype=float))
    n, more, less = len(difference), int((difference > 0.0).sum()), int((difference < 0.0).sum())
    if n == 0:
        return Difference(difference=None, low=None, high=None, n=0, p=None)
    low, high = paired_rates_interval(more, less, n, confidence)
    p = float(stats.binomtest(more, more + less).pvalue) if more + less else 1.0
    return Difference(difference=(more - less) / n, low=low, high=high, n=n, p=p)


def paired_rates_interval(more: int, less: int, n: int, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """Returns the interval of a difference of paired rates, see the module.

    Args:
        more: Pairs with a one in the first condition only.
        less: Pairs with a one in the second condition only.
        n: All pairs, at least one.
        confidence: Of the interval.
    """
    observed, edge = (more - less) / n, 1.0 - 1e-12
    bound = float(stats.norm.isf(0.5 * (1.0 - confidence)))

    def score(difference: float) -> float:
        """Tango's statistic (1998, Eq. 11): standard normal if this were the difference."""
        linear = -more - less + (2.0 * n - more + less) * difference
        constant = -less * difference * (1.0 - difference)
        only_second = (math.sqrt(max(linear**2 - 8.0 * n * constant, 0.0)) - linear) / (4.0 * n)
        variance = n * (2.0 * only_second + difference * (1.0 - difference))
        return (more - less - n * difference) / math.sqrt(max(variance, 1e-300))

    low = optimize.brentq(lambda d: score(d) - bound, -edge, observed) if score(-edge) > bound else -1.0
    high = optimize.brentq(lambda d: score(d) + bound, observed, edge) if score(edge) < -bound else 1.0
    if discordant := more + less:
        exact = stats.binomtest(more, discordant).proportion_ci(confidence, method="exact")
        low = min(low, (2.0 * exact.low - 1.0) * discordant / n)
        high = max(high, (2.0 * exact.high - 1.0) * discordant / n)
    return float(low), float(high)


def holm(values: Sequence[float | None]) -> list[float | None]:
    """Returns Holm's adjustment of the p values of one family; undefined ones do not count and stay undefined."""
    known = [value for value in values if value is not None]
    adjusted = iter(multitest.multipletests(known, method="holm")[1].tolist() if known else [])
    return [None if value is None else next(adjusted) for value in values]


def constant(values: Array) -> bool:
    """Tells whether values differ by no more than rounding."""
    return bool(np.ptp(values) <= 1e-9 * max(1.0, float(np.abs(values).max())))


def _finite(values: npt.ArrayLike) -> Array:
    array = np.asarray(values, dtype=float)
    return array[np.isfinite(array)]
