import itertools

import numpy as np
import pytest
from scipy import stats

from dynabot_mj.common import intervals


def test_wilson_interval_by_hand():
    # (p + z^2 / 2n -+ z sqrt(p (1 - p) / n + z^2 / 4 n^2)) / (1 + z^2 / n) with p = 0.16, n = 100, z = 1.95996.
    rate = intervals.rate([1] * 16 + [0] * 84 + [np.nan] * 5)
    assert (rate.k, rate.n, rate.rate) == (16, 100, 0.16)
    assert (rate.low, rate.high) == pytest.approx((0.100953, 0.244203), abs=1e-6)


def test_no_collision_in_a_hundred_still_allows_three_percent():
    # z^2 / (n + z^2)
    assert intervals.rate(np.zeros(100)).high == pytest.approx(3.8415 / 103.8415, abs=1e-5)


def test_undefined_values_are_none():
    assert intervals.rate([np.nan]).rate is None
    assert intervals.mean([]).mean is None
    one = intervals.mean([3.0, np.nan])
    assert (one.mean, one.sd, one.n) == (3.0, None, 1)
    assert intervals.paired_difference([np.nan, 1.0], [1.0, np.nan]).difference is None


def test_standard_deviation_is_the_samples():
    assert intervals.mean([1.0, 2.0, 3.0, 4.0]).sd == pytest.approx(np.sqrt(5.0 / 3.0))


def test_paired_difference_uses_only_trials_with_both():
    a, b = np.array([5.0, 6.0, np.nan, 9.0]), np.array([4.0, 4.0, 1.0, np.nan])
    difference = intervals.paired_difference(a, b)
    assert (difference.difference, difference.n) == (1.5, 2)


def test_bootstrap_interval_is_that_of_the_mean_and_is_seeded():
    a = np.random.default_rng(0).normal(1.0, 2.0, 400)
    difference = intervals.paired_difference(a, np.zeros(400), seed=3)
    assert difference == intervals.paired_difference(a, np.zeros(400), seed=3)
    # For 400 values the interval is mean -+ 1.96 s / 20 up to skewness and resampling, a few percent.
    half = 1.95996 * a.std(ddof=1) / 20.0
    assert difference.low == pytest.approx(a.mean() - half, abs=0.1 * half)
    assert difference.high == pytest.approx(a.mean() + half, abs=0.1 * half)


def test_bca_corrects_for_skewness_and_a_constant_has_an_interval_of_no_width():
    skewed = np.random.default_rng(1).exponential(1.0, 200)
    found = intervals.bootstrapped(skewed)
    assert found.high - found.mean > found.mean - found.low
    assert intervals.bootstrapped([2.0] * 6 + [np.nan]) == intervals.MeanInterval(mean=2.0, low=2.0, high=2.0)
    # Rounding about a constant is no spread: resampling it, the interval would be undefined.
    nearly = intervals.bootstrapped([0.9999999999999999, 1.0, 1.0000000000000002] * 4)
    assert (nearly.low, nearly.high) == pytest.approx((1.0, 1.0))


def test_a_handful_of_values_has_a_mean_and_no_interval():
    assert intervals.bootstrapped([1.0, 2.0, 3.0, 4.0, 5.0]) == intervals.MeanInterval(mean=3.0, low=None, high=None)


def test_the_permutation_test_is_exact_where_it_can_be():
    """Six pairs all on one side: of the 64 ways to sign them, the two extreme ones are as extreme."""
    assert intervals.paired_difference([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], np.zeros(6)).p == pytest.approx(2 / 64)
    assert intervals.paired_difference([1.0, -1.0, 2.0, -2.0], np.zeros(4)).p == 1.0


def test_hazard_by_hand():
    # No event in 100 min: the upper bound of a Poisson mean is -ln 0.025 = 3.689.
    assert intervals.hazard(0, 100.0).high == pytest.approx(0.03689, abs=1e-5)
    three = intervals.hazard(3, 10.0)
    # Exact: the means at which 3 or more, and 3 or fewer, have a probability of 2.5 %.
    assert stats.poisson.sf(2, 10.0 * three.low) == pytest.approx(0.025)
    assert stats.poisson.cdf(3, 10.0 * three.high) == pytest.approx(0.025)
    assert intervals.hazard(0, 0.0).rate is None


def pairs(more, less, n):
    """Zeros and ones with that many pairs that differ either way."""
    a = np.r_[np.ones(more), np.zeros(n - more)]
    b = np.r_[np.zeros(more), np.ones(less), np.zeros(n - more - less)]
    return a, b


def test_mcnemars_exact_test_by_hand():
    four = intervals.paired_rates(*pairs(4, 0, 100))
    assert (four.difference, four.n, four.p) == (0.04, 100, 0.125)  # 2 / 2^4
    assert four.low < 0.0 < four.high  # where a percentile bootstrap excludes zero
    assert intervals.paired_rates(*pairs(6, 0, 100)).low > 0.0  # 2 / 2^6 = 0.031
    assert intervals.paired_rates(*pairs(0, 0, 100)).p == 1.0
    assert intervals.paired_rates([np.nan], [1.0]).difference is None


def test_tangos_interval_by_its_closed_form_without_discordant_pairs():
    # With b = c = 0 the statistic is -n d / sqrt(n (2 q + d (1 - d))) with q = 0 for d > 0, and by symmetry: the
    # bounds are +- z^2 / (n + z^2).
    found = intervals.paired_rates(*pairs(0, 0, 100))
    z2 = stats.norm.isf(0.025) ** 2
    assert (found.low, found.high) == pytest.approx((-z2 / (100 + z2), z2 / (100 + z2)), abs=1e-6)


def test_interval_and_exact_test_never_contradict_each_other():
    found = {}
    for more, less in itertools.product(range(26), repeat=2):
        rates = intervals.paired_rates(*pairs(more, less, 60))
        found[more, less] = rates.low, rates.high
        assert (rates.low < 0.0 < rates.high) == (rates.p > 0.05), (more, less)
    for (more, less), (low, high) in found.items():
        mirrored = found[less, more]
        assert (low, high) == pytest.approx((-mirrored[1], -mirrored[0]), abs=1e-9)


def test_holm_by_hand_and_what_is_undefined_does_not_count():
    # Sorted .01, .02, .03: times 3, 2, 1, each at least the one before.
    assert intervals.holm([0.03, None, 0.01, 0.02]) == pytest.approx([0.04, None, 0.03, 0.04])
    assert intervals.holm([None]) == [None]


def test_the_medians_interval_is_of_order_statistics():
    values = np.random.default_rng(0).permutation(np.arange(1.0, 101.0))
    found = intervals.median(values)
    # Of 100 coins, 39 heads or fewer have a probability of 1.76 %, 40 or fewer of 2.84 %: the 40th and the 61st.
    assert (found.median, found.low, found.high) == (50.5, 40.0, 61.0)
    assert intervals.median([1.0, 2.0, np.nan]) == intervals.Median(median=1.5, low=None, high=None)
    assert intervals.median([]).median is None


def test_a_median_is_as_open_as_its_values():
    least = np.r_[np.arange(60.0), np.full(40, 60.0)]
    most = np.r_[np.arange(60.0), np.full(40, np.inf)]
    assert intervals.median_between(least, most) == intervals.Median(median=49.5, low=39.0, high=None)
    # Exactly half of the values known: the median is between the last of them and whatever follows.
    assert intervals.median_between([1.0, 2.0, 9.0, 9.0], [1.0, 2.0, np.inf, np.inf]).median is None
    nothing = np.full(100, np.inf)
    assert intervals.median_between(-nothing, nothing) == intervals.Median(median=None, low=None, high=None)


def test_beyond_many_values_the_normal_law_says_what_resampling_does():
    difference = np.random.default_rng(0).exponential(1.0, intervals.MANY) - 0.98  # skewed, 1.4 errors from zero
    few = intervals.paired_difference(difference, np.zeros(intervals.MANY))
    many = np.r_[difference, difference.mean()]
    found = intervals.paired_difference(many, np.zeros(len(many)))
    width = few.high - few.low
    # BCa shifts the ends by skewness (z^2 - 1) / (6 sqrt(n)) = 1.3 % of the error, and 10,000 resamples leave 1.5 % of
    # it (the standard error of a 2.5 % quantile is 2.7 errors / sqrt(10,000)); 3 of both are 6 % of 3.92 errors.
    assert found.low == pytest.approx(few.low, abs=0.02 * width)
    assert found.high == pytest.approx(few.high, abs=0.02 * width)
    # The share of 10,000 permutations has a standard error of at most 0.005.
    assert found.p == pytest.approx(few.p, abs=0.02)
    assert intervals.paired_difference(np.zeros(6_000), np.zeros(6_000)).p == 1.0
