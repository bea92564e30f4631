import numpy as np
import pytest

from dynabot_mj.estimation.filterpy_twins.filters import MovingFilter, judged, linear, sound


def test_the_model_moves_the_state_and_its_jacobian_the_covariance():
    one = MovingFilter(2, 1)
    one.moved = np.array([3.0, -4.0])
    one.F, one.Q = np.diag([2.0, 0.0]), np.diag([0.5, 0.25])
    one.predict()
    np.testing.assert_array_equal(one.x, [3.0, -4.0])
    np.testing.assert_allclose(one.P, np.diag([4.5, 0.25]))


@pytest.mark.parametrize(("gate", "z", "accepted"), [(2.1, 2.0, True), (1.9, 2.0, False), (2.1, np.nan, False)])
def test_what_fails_the_gate_is_taken_back(gate, z, accepted):
    # Variances of belief and measurement are 1: S = 2, so z = 2 has a NIS of 2 and moves the state by half.
    one = linear(1.0)
    update = judged(one, gate, np.array([z]), np.array(z), R=np.eye(1))
    assert bool(update.accepted) == accepted
    np.testing.assert_allclose(one.x, [1.0 if accepted else 0.0])
    np.testing.assert_allclose(one.P, [[0.5 if accepted else 1.0]])
    np.testing.assert_allclose(update.squared, z**2 / 2.0)


@pytest.mark.parametrize(
    ("state", "variance", "expected"), [(0.0, 1.0, True), (np.nan, 1.0, False), (0.0, 0.0, False), (0.0, 1e9, False)]
)
def test_sound_are_finite_numbers_with_variances_that_mean_something(state, variance, expected):
    one = linear(1.0)
    one.x, one.P = np.array([state]), np.array([[variance]])
    assert sound(one) == expected
