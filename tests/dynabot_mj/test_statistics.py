import numpy as np
import pytest

from dynabot_mj import statistics


def test_wilson_interval_by_hand():
    # (p + z^2 / 2n -+ z sqrt(p (1 - p) / n + z^2 / 4 n^2)) / (1 + z^2 / n) with p = 0.16, n = 100, z = 1.95996.
    rate = statistics.rate([1] * 16 + [0] * 84 + [np.nan] * 5)
    assert (rate.k, rate.n, rate.rate) == (16, 100, 0.16)
    assert (rate.low, rate.high) == pytest.approx((0.100953, 0.244203), abs=1e-6)


def test_no_collision_in_a_hundred_still_allows_three_percent():
    # z^2 / (n + z^2)
    assert statistics.rate(np.zeros(100)).high == pytest.approx(3.8415 / 103.8415, abs=1e-5)


def test_undefined_values_are_none():
    assert statistics.rate([np.nan]).rate is None
    assert statistics.mean([]).mean is None
    one = statistics.mean([3.0, np.nan])
    assert (one.mean, one.sd, one.n) == (3.0, None, 1)
    assert statistics.paired_difference([np.nan, 1.0], [1.0, np.nan]).difference is None


def test_standard_deviation_is_the_samples():
    assert statistics.mean([1.0, 2.0, 3.0, 4.0]).sd == pytest.approx(np.sqrt(5.0 / 3.0))


def test_paired_difference_uses_only_trials_with_both():
    a, b = np.array([5.0, 6.0, np.nan, 9.0]), np.array([4.0, 4.0, 1.0, np.nan])
    difference = statistics.paired_difference(a, b)
    assert (difference.difference, difference.n) == (1.5, 2)


def test_bootstrap_interval_is_that_of_the_mean_and_is_seeded():
    a = np.random.default_rng(0).normal(1.0, 2.0, 400)
    difference = statistics.paired_difference(a, np.zeros(400), seed=3)
    assert difference == statistics.paired_difference(a, np.zeros(400), seed=3)
    # For 400 values the percentile interval is mean -+ 1.96 s / 20 up to skewness and resampling, a few percent.
    half = 1.95996 * a.std(ddof=1) / 20.0
    assert difference.low == pytest.approx(a.mean() - half, abs=0.1 * half)
    assert difference.high == pytest.approx(a.mean() + half, abs=0.1 * half)
