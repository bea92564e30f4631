from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.perception.belief import certain
from dynabot_mj.perception.error_statistics import LAGS, ErrorRecorder, components
from dynabot_mj.plants.plant import FleetState, NavigationError

PERIOD = 0.0625
SHAPE = (20, 3)
ALL = np.ones(SHAPE, dtype=bool)
ZERO = np.zeros((*SHAPE, 2))


def recorded(errors, headings=None, known=ALL):
    """Takes position errors (K, B, n, 2), and heading errors (K, B, n)."""
    recorder = ErrorRecorder(PERIOD, SHAPE)
    state = FleetState(
        time=0.0,
        position_w=ZERO,
        velocity_w=ZERO,
        heading=ZERO[..., 0],
        yaw_rate=ZERO[..., 0],
        velocity_increment_b=ZERO,
    )
    for index, error in enumerate(errors):
        navigation = None
        if headings is not None:
            navigation = NavigationError(heading=headings[index], yaw_rate=ZERO[..., 0], acceleration_b=ZERO)
        recorder.take(replace(certain(error, 2.0 * error), known=known), state, navigation, ALL)
    return recorder


def test_autocovariance_by_its_definition():
    errors = np.random.default_rng(0).normal(size=(40, *SHAPE, 2))
    found = recorded(errors).statistics()
    for index, lag in enumerate(LAGS):
        step = round(lag / PERIOD)
        assert found.lag[0, index] == pytest.approx(step * PERIOD)
        if step >= len(errors):
            assert np.isnan(found.position[:, index]).all()
            continue
        for trial in (0, 19):
            products = [errors[k, trial] * errors[k + step, trial] for k in range(len(errors) - step)]
            assert found.position[trial, index] == pytest.approx(np.mean(products), rel=1e-5, abs=1e-6)
    np.testing.assert_allclose(found.velocity, 4.0 * found.position, rtol=1e-5, atol=1e-6)
    assert np.isnan(found.heading).all()  # there was none


def test_what_robots_do_not_know_is_no_error_but_counted():
    errors = np.full((4, *SHAPE, 2), 0.5)
    errors[:, :, 2] = 50.0
    known = ALL.copy()
    known[:, 2] = False
    found = recorded(errors, known=known).statistics()
    np.testing.assert_allclose(found.position[:, 0], 0.25)
    np.testing.assert_allclose(found.stale, 1.0 / 3.0)
    np.testing.assert_array_equal(found.restarts, 0.0)


def test_a_trial_has_the_same_bits_alone_and_among_others():
    errors = np.random.default_rng(1).normal(size=(60, *SHAPE, 2)).astype(np.float32)
    together = recorded(errors).statistics().position[7]
    alone = np.tile(errors[:, 7:8], (1, SHAPE[0], 1, 1))
    np.testing.assert_array_equal(recorded(alone).statistics().position[3], together)


def test_heading_errors_are_wrapped():
    headings = np.full((3, *SHAPE), 2.0 * np.pi - 0.1)
    np.testing.assert_allclose(recorded(np.zeros((3, *SHAPE, 2)), headings).statistics().heading[:, 0], 0.01, rtol=1e-4)


def test_robots_with_clocks_of_their_own_have_no_common_statistics():
    recorder = recorded(np.ones((3, *SHAPE, 2)))
    some = ALL.copy()
    some[:, 0] = False
    state = FleetState(
        time=1.0,
        position_w=ZERO,
        velocity_w=ZERO,
        heading=ZERO[..., 0],
        yaw_rate=ZERO[..., 0],
        velocity_increment_b=ZERO,
    )
    recorder.take(certain(ZERO, ZERO), state, None, some)
    assert np.isnan(recorder.statistics().position).all()


@pytest.mark.parametrize(
    "made", [[(0.8, 60.0)], [(0.5, 0.1)], [(1.0, 0.11), (0.77, 75.0)]], ids=["slow", "fast", "both"]
)
def test_components_are_found_in_an_exact_autocovariance(made):
    lag = np.array(LAGS)
    covariance = sum(sigma**2 * np.exp(-lag / tau) for sigma, tau in made)
    found = [(one.deviation, one.time) for one in components(lag, covariance)]
    assert sum(deviation**2 for deviation, _ in found) == pytest.approx(covariance[0])
    np.testing.assert_allclose(found, made, rtol=0.02)


def test_no_error_has_no_components():
    assert components(np.array(LAGS), np.zeros(len(LAGS))) == []
    assert components(np.array(LAGS), np.full(len(LAGS), np.nan)) == []
