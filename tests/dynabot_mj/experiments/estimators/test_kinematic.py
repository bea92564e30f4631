import numpy as np
import pytest
from scipy import special

from dynabot_mj.experiments.estimators import kinematic

MOVING = 7.0  # after four seconds of rest and three of acceleration [s]


@pytest.fixture(scope="module")
def circling():
    return kinematic.follow("circle", 3, 0, 20.0, 0.05)


def test_it_rests_speeds_up_evenly_and_keeps_its_speed(circling):
    speed = np.linalg.norm(circling.velocity_w, axis=-1)
    expected = np.clip(circling.time - 4.0, 0.0, 3.0)
    np.testing.assert_allclose(speed, np.broadcast_to(expected[:, None], speed.shape), atol=1e-12)
    resting = circling.time <= 4.0
    np.testing.assert_array_equal(circling.position_w[resting], 0.0)


def test_the_circle_is_one_of_seven_metres(circling):
    start = circling.heading[0]
    centre_w = 7.0 * np.stack([-np.sin(start), np.cos(start)], axis=-1)  # to the left
    np.testing.assert_allclose(np.linalg.norm(circling.position_w - centre_w, axis=-1), 7.0, rtol=1e-7)
    np.testing.assert_allclose(circling.yaw_rate[circling.time >= MOVING], 3.0 / 7.0)
    assert len(np.unique(start)) == 3  # each run is turned by an angle of its own


def test_accelerometers_feel_what_the_way_costs(circling):
    # Ahead the speed; to the left the integral of v^2 / R: 9 / 7 m/s in three seconds of acceleration, and 9 / 7 m/s in
    # each of the thirteen that follow.
    np.testing.assert_allclose(circling.velocity_increment_b[-1, :, 0], 3.0)
    np.testing.assert_allclose(circling.velocity_increment_b[-1, :, 1], 9.0 / 7.0 * (1.0 + 13.0), rtol=1e-7)


def test_the_figure_of_eight_closes_and_is_nowhere_tighter_than_the_circle():
    # Its heading swings by the first zero of J_0, so it is 2 pi times that zero times its smallest radius long.
    round_time = 2.0 * np.pi * special.jn_zeros(0, 1)[0] * 7.0 / 3.0
    interval = round_time / 1000
    truth = kinematic.follow("figure-eight", 1, 0, 1300 * interval, interval)
    begin = np.searchsorted(truth.time, MOVING)
    np.testing.assert_allclose(truth.position_w[begin + 1000], truth.position_w[begin], atol=1e-6)
    assert np.abs(truth.yaw_rate).max() == pytest.approx(3.0 / 7.0, rel=1e-4)
    assert truth.yaw_rate.min() == pytest.approx(-3.0 / 7.0, rel=1e-4)  # it turns both ways


def test_a_run_has_the_angle_of_its_number():
    together = kinematic.follow("line", 3, 5, 8.0, 0.1)
    alone = kinematic.follow("line", 1, 5, 8.0, 0.1, first=2)
    np.testing.assert_array_equal(alone.position_w[:, 0], together.position_w[:, 2])
    # 4.5 m of acceleration and one second more, straight on.
    np.testing.assert_allclose(np.linalg.norm(alone.position_w[-1], axis=-1), 4.5 + 3.0)
