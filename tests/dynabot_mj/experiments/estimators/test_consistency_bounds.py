import numpy as np
import pytest

from dynabot_mj.estimation.kalman import Update
from dynabot_mj.experiments.estimators import consistency_bounds


def test_bounds_hold_what_they_say():
    rng = np.random.default_rng(0)
    low, high = consistency_bounds.bounds(4, 64)
    means = rng.chisquare(4, (20_000, 64)).mean(axis=1)
    assert np.mean((means > low) & (means < high)) == pytest.approx(consistency_bounds.CONFIDENCE, abs=0.003)


def test_innovations_are_made_unit():
    rng = np.random.default_rng(0)
    root = np.array([[1.0, 0.0], [0.8, 0.3]])
    drawn = rng.standard_normal((4000, 2)) @ root.T
    update = Update(
        state=drawn,
        covariance=drawn,
        innovation=drawn,
        innovation_covariance=np.broadcast_to(root @ root.T, (4000, 2, 2)),
        squared=drawn[:, 0],
        accepted=np.ones(4000, dtype=bool),
    )
    np.testing.assert_allclose(np.cov(consistency_bounds.unit(update).T), np.eye(2), atol=0.08)


def test_autocorrelation_of_a_first_order_sequence():
    rng = np.random.default_rng(0)
    values = np.zeros((4000, 4, 1))
    for index in range(1, len(values)):
        values[index] = 0.8 * values[index - 1] + 0.6 * rng.standard_normal((4, 1))
    np.testing.assert_allclose(
        consistency_bounds.autocorrelation(values)[:, 0], 0.8 ** np.arange(1, consistency_bounds.LAGS + 1), atol=0.05
    )


def test_squares_that_are_too_large_or_too_small_show():
    values = np.random.default_rng(0).chisquare(2, (200, 30))
    for judge in (consistency_bounds.nees, consistency_bounds.nis):
        verdicts = [judge("x", factor * values, 2).verdict for factor in (0.5, 1.0, 2.0)]
        assert verdicts == ["too large", "consistent", "too small"]
    assert consistency_bounds.nis("x", values, 2).inside > 0.95


def test_runs_that_are_too_few_to_say_are_said_to_be():
    """Eight runs whose means scatter from 2 to 100 leave bounds of 10 +- 36: a mean of 46 is within them."""
    by_run = np.array([2.0, 5.0, 20.0, 40.0, 60.0, 61.0, 80.0, 100.0])
    judged = consistency_bounds.nees("x", np.broadcast_to(by_run, (50, 8)), 10)
    assert judged.low < judged.mean == 46.0 < judged.high
    assert judged.verdict == "too few runs to say"
    # Eight times as many of the same runs have bounds narrower by a factor of three, and tell.
    assert consistency_bounds.nees("x", np.tile(by_run, (50, 8)), 10).verdict == "too small"
