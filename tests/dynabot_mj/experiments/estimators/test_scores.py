from types import SimpleNamespace

import numpy as np
import pytest

from dynabot_mj.experiments.estimators import kinematic
from dynabot_mj.experiments.estimators import scores as estimation_scores
from dynabot_mj.experiments.estimators.scores import Consistency
from dynabot_mj.sensing.replay import Track

RUNS, FIRST = 2, 10


@pytest.fixture
def truth():
    return kinematic.follow("circle", RUNS, 0, 60.0, 0.1)


def track(truth, **changes):
    """What an estimator believed that was right, but for the changes."""
    shape = truth.heading.shape
    exact = {
        "time": truth.time,
        "position_w": truth.position_w,
        "velocity_w": truth.velocity_w,
        "heading": truth.heading,
        "position_covariance": np.tile(np.eye(2), (*shape, 1, 1)),
        "velocity_covariance_b": np.tile(np.eye(2), (*shape, 1, 1)),
        "heading_variance": np.ones(shape),
        "known": np.ones(shape, dtype=bool),
        "fix_age": np.zeros(shape),
        "restarts": np.zeros(RUNS, dtype=np.int64),
    }
    return Track(**(exact | changes))


def judged(truth, **changes):
    unseen = Consistency(SimpleNamespace(filter=None, fix_updates=([], ())), np.zeros((1, RUNS, 10)), FIRST)
    return estimation_scores.judge("circle", track(truth, **changes), truth, unseen, FIRST)[0]


def test_a_shift_is_an_error_but_no_uncertainty(truth):
    scores = judged(truth, position_w=truth.position_w + np.array([3.0, -4.0]))
    np.testing.assert_allclose(scores.true_error, 5.0)
    np.testing.assert_allclose(scores.rms, np.sqrt(12.5))
    np.testing.assert_allclose([scores.rms_mean_removed, scores.uncertainty], 0.0, atol=1e-9)


def test_what_comes_before_the_first_sample_that_counts_is_no_error(truth):
    wrong = truth.position_w.copy()
    wrong[:FIRST] += 100.0
    np.testing.assert_allclose(judged(truth, position_w=wrong).true_error, 0.0)


def test_headings_differ_by_less_than_half_a_turn(truth):
    scores = judged(truth, heading=truth.heading + 6.0 * np.pi - 0.1)
    np.testing.assert_allclose(scores.heading_rms, 0.1)


def test_a_run_whose_estimator_was_lost_has_no_score_and_disturbs_no_other(truth):
    known = np.ones_like(truth.heading, dtype=bool)
    known[300, 0] = False
    lost = truth.position_w + np.array([1.0, 0.0])
    lost[300, 0] = np.nan
    scores = judged(truth, position_w=lost, known=known)
    for value in (scores.uncertainty, scores.true_error, scores.rms, scores.heading_rms):
        assert np.isnan(value[0])
        assert np.isfinite(value[1])
    assert scores.true_error[1] == pytest.approx(1.0)


class FilterOfAllStates:
    def __init__(self, state, covariance):
        self.state, self.covariance, self.fine = state, covariance, np.ones(len(state), dtype=bool)

    def moments(self):
        return self.state, self.covariance

    def sound(self):
        return self.fine


def test_nees_and_nis_are_means_over_samples_and_fixes():
    state = np.zeros((3, RUNS, 10))
    state[..., 4] = np.pi - 0.1
    believed = np.zeros((RUNS, 10))
    believed[:, 4] = -np.pi + 0.1  # 0.2 rad further on
    believed[1, 0] = 3.0
    covariance = np.tile(np.diag([4.0] + [0.01] * 9), (RUNS, 1, 1))
    estimator = SimpleNamespace(filter=FilterOfAllStates(believed, covariance), fix_updates=(np.arange(0), ()))
    watched = Consistency(estimator, state, 1)
    watched.collect(0)  # does not count
    estimator.fix_updates = (np.array([1]), (SimpleNamespace(squared=2.0), SimpleNamespace(squared=1.0)))
    watched.collect(1)
    estimator.fix_updates = (np.array([1]), (SimpleNamespace(squared=5.0),))
    watched.collect(2)
    np.testing.assert_allclose(watched.nees, [0.04 / 0.01, 0.04 / 0.01 + 9.0 / 4.0])
    np.testing.assert_allclose(watched.nis, [np.nan, 4.0])


def test_the_true_states_have_their_velocity_in_body_axes():
    truth = kinematic.follow("circle", RUNS, 0, 20.0, 0.1)
    errors = np.zeros((*truth.heading.shape, 5))
    errors[...] = np.arange(5.0, 10.0)
    state = estimation_scores.ten_states(truth, SimpleNamespace(errors=errors))
    np.testing.assert_allclose(state[-1, :, 2:4], [[kinematic.SPEED, 0.0]] * RUNS, atol=1e-12)
    np.testing.assert_array_equal(state[-1, :, 4], truth.heading[-1])
    np.testing.assert_array_equal(state[-1, 0, 5:], np.arange(5.0, 10.0))
