import numpy as np
import pytest

from dynabot_mj.formation.metrics import polygon_radius, restricted, settling_time, trailing_mean

from .conftest import FORMATION


def test_settling_of_an_exponential_approach():
    time = np.arange(0.0, 80.0, 0.01)
    radius = 3.0 + 47.0 * np.exp(-time / 5.0)
    # The trailing 3 s mean of exp(-t / tau) is exp(-t / tau) tau (e^{3 / tau} - 1) / 3; it passes 0.5 m at
    # t = tau ln(94 tau (e^{3 / tau} - 1) / 3).
    exact = 5.0 * np.log(94.0 * 5.0 * (np.exp(0.6) - 1.0) / 3.0)
    assert settling_time(time, radius[:, None], 0.5)[0] == pytest.approx(exact, abs=0.03)


def test_a_signal_that_is_outside_at_the_end_has_not_settled():
    time = np.arange(0.0, 80.0, 0.1)
    drifting, still = 3.0 + 0.3 * np.maximum(time - 70.0, 0.0), np.full_like(time, 3.0)
    settling = settling_time(time, np.stack([drifting, still], axis=-1), 0.5)
    assert np.isnan(settling[0])
    assert settling[1] == 0.0


def test_the_polygons_radius_is_the_middle_of_what_the_floors_admit():
    # Three robots: the floor between them ends at (d0 + 1) / sqrt(3) = 3.577 m, before the leader's at 4 m.
    assert polygon_radius(FORMATION, 3) == pytest.approx((3.0 + (np.sqrt(27.0) + 1) / np.sqrt(3.0)) / 2)
    assert polygon_radius(FORMATION, 3) == pytest.approx(3.289, abs=5e-4)


def test_the_trailing_mean_is_of_the_last_three_seconds_and_shorter_at_the_start():
    time = np.arange(0.0, 10.0, 0.5)
    smooth = trailing_mean(time, time[:, None])[:, 0]
    # Samples of (t - 3 s, t]: six, where they are there.
    by_hand = [time[max(0, k - 5) : k + 1].mean() for k in range(len(time))]
    np.testing.assert_allclose(smooth, by_hand)


def test_what_happens_late_or_after_a_contact_counts_as_the_horizon():
    event = np.array([30.0, 90.0, np.nan, 30.0, 30.0])
    failure = np.array([np.nan, np.nan, 10.0, 20.0, 40.0])
    np.testing.assert_array_equal(restricted(event, failure, 80.0), [30.0, 80.0, 80.0, 80.0, 30.0])
