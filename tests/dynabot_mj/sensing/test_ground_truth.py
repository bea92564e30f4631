import numpy as np
import pytest

from dynabot_mj.sensing.ground_truth import GroundTruth


@pytest.fixture
def truth():
    """Two runs at seven times, every number another one."""
    numbers = np.random.default_rng(0)
    return GroundTruth(
        time=0.5 * np.arange(7),
        position_w=numbers.normal(size=(7, 2, 2)),
        velocity_w=numbers.normal(size=(7, 2, 2)),
        heading=numbers.normal(size=(7, 2)),
        yaw_rate=numbers.normal(size=(7, 2)),
        velocity_increment_b=numbers.normal(size=(7, 2, 2)),
        wheel_speed=numbers.normal(size=(7, 2, 4)),
    )


def test_one_time_in_three_is_kept_of_everything_that_there_is(truth):
    thin = truth.thinned(3)
    assert (thin.runs, thin.interval) == (2, 1.5)
    for name in ("time", "position_w", "velocity_w", "heading", "yaw_rate", "velocity_increment_b", "wheel_speed"):
        np.testing.assert_array_equal(getattr(thin, name), getattr(truth, name)[[0, 3, 6]], err_msg=name)
    assert thin.motor_current is None


def test_runs_are_trials_of_one_robot(truth):
    state = truth.state(4)
    assert state.time == 2.0
    assert state.heading.shape == (2, 1)
    np.testing.assert_array_equal(state.position_w[:, 0], truth.position_w[4])
    np.testing.assert_array_equal(state.velocity_increment_b[:, 0], truth.velocity_increment_b[4])
