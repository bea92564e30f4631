import math

import numpy as np
import pytest

from dynabot_mj.common.streams import Draws, Purpose
from dynabot_mj.estimation.gauss_markov import Component
from dynabot_mj.perception.surrogates import ErrorSequence, FittedPerception, GaussMarkovPerception, PerfectPerception
from dynabot_mj.plants.plant import FleetState

ZERO = np.zeros((300, 3, 2))


STATE = FleetState(
    time=0.0,
    position_w=ZERO + 5.0,
    velocity_w=ZERO + 1.0,
    heading=ZERO[..., 0],
    yaw_rate=ZERO[..., 0],
    velocity_increment_b=ZERO,
)


EVERYBODY = np.ones((300, 3), dtype=bool)


def test_uncertainty_is_the_planar_distances():
    perception = GaussMarkovPerception(1.1 / np.sqrt(2.0), 0.08, 0.036, 3, 0, range(300))
    for _ in range(20):
        belief = perception.observe(STATE, EVERYBODY)
    error = belief.position_w - STATE.position_w
    # Mean of 900 squared distances; a sum of two squared normals of variance sigma^2 / 2 has standard deviation
    # sigma^2, so the mean's is sigma^2 / 30.
    assert abs((error**2).sum(axis=-1).mean() - 1.21) < 4.5 * 1.21 / 30.0
    np.testing.assert_array_equal(belief.velocity_w, STATE.velocity_w)


def test_robots_that_are_not_due_keep_their_error():
    perception = GaussMarkovPerception(1.1, 0.08, 0.036, 3, 0, range(300))
    first = perception.observe(STATE, EVERYBODY).position_w
    due = EVERYBODY.copy()
    due[:, 1] = False
    second = perception.observe(STATE, due).position_w
    np.testing.assert_array_equal(second[:, 1], first[:, 1])
    assert (second[:, [0, 2]] != first[:, [0, 2]]).all()


def test_perfect_perception_is_the_truth():
    belief = PerfectPerception().observe(STATE, EVERYBODY)
    np.testing.assert_array_equal(belief.position_w, STATE.position_w)


def test_a_sequence_has_the_statistics_of_its_components():
    made = [Component(deviation=1.0, time=0.1), Component(deviation=0.5, time=2.0)]
    trials = 400
    draws = Draws(0, range(trials), Purpose.FITTED_POSITION, (3, 2, 2), normal=True)
    sequence = ErrorSequence(made, 0.1, (trials, 3, 2), draws)
    due = np.ones((trials, 3), dtype=bool)
    errors = np.stack([sequence.next(due) for _ in range(6)])
    variance = 1.25
    # 2,400 independent errors: 4.5 standard deviations of the mean of their squares and products.
    bound = 4.5 * variance * math.sqrt(2.0 / 2400)
    assert (errors[0] ** 2).mean() == pytest.approx(variance, abs=bound)
    assert (errors[5] ** 2).mean() == pytest.approx(variance, abs=bound)
    expected = math.exp(-5.0) + 0.25 * math.exp(-0.25)
    assert (errors[0] * errors[5]).mean() == pytest.approx(expected, abs=bound)


def test_fitted_errors_are_of_position_velocity_and_the_heading_that_local_laws_use():
    def of(*deviations):
        return [Component(deviation=one, time=1.0) for one in deviations]

    perception = FittedPerception(of(0.3, 0.4), of(0.2), of(0.1), 0.036, 3, 0, range(300))
    assert not perception.navigation_error(0.0).heading.any()  # nothing has been sampled yet
    belief, wrong = perception.observe(STATE, EVERYBODY), perception.navigation_error(0.0)
    # 1,800 and 900 independent errors: 4.5 standard deviations of the mean of their squares.
    for error, variance in (
        (belief.position_w - STATE.position_w, 0.25),
        (belief.velocity_w - STATE.velocity_w, 0.04),
        (wrong.heading, 0.01),
    ):
        assert (error**2).mean() == pytest.approx(variance, rel=4.5 * math.sqrt(2.0 / error.size))
    np.testing.assert_allclose(belief.position_covariance, np.broadcast_to(0.25 * np.eye(2), (300, 3, 2, 2)))
    assert not wrong.yaw_rate.any()
    assert wrong.acceleration_b is None


def test_ideal_local_laws_are_told_of_no_error():
    for perception in (PerfectPerception(), GaussMarkovPerception(1.1, 0.08, 0.036, 3, 0, range(300))):
        assert perception.navigation_error(0.0) is None
