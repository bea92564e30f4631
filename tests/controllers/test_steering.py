import numpy as np
import pytest

from controllers.steering import HandPoint, steer

GAINS = HandPoint()
MASS, PERIOD = 12.0, 0.036


def step(reference, force, heading=0.0, speed=0.0):
    return steer(
        np.array(reference, float),
        np.array(force, float),
        np.array(heading, float),
        np.array(speed, float),
        mass=MASS,
        period=PERIOD,
        gains=GAINS,
    )


def test_rest_without_force_stays_rest():
    reference, motion = step([0.0, 0.0], [0.0, 0.0])
    np.testing.assert_array_equal(reference, 0.0)
    assert motion.speed == motion.yaw_rate == motion.acceleration == 0.0


def test_a_force_ahead_asks_for_the_point_masss_speed():
    reference, motion = step([0.0, 0.0], [24.0, 0.0])
    # F T / m but for the pull to the robot's rest, of second order: k T / 2 of it.
    assert motion.speed == pytest.approx(24.0 * PERIOD / MASS, rel=GAINS.hold * PERIOD)
    assert motion.acceleration == pytest.approx(2.0)
    assert motion.yaw_rate == 0.0
    assert reference[1] == 0.0


def test_a_force_behind_asks_for_reversing_without_turning():
    _, motion = step([0.0, 0.0], [-24.0, 0.0])
    assert motion.speed < 0.0
    assert motion.yaw_rate == 0.0


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_lateral_force_at_rest_turns_the_robot_toward_it(side):
    _, motion = step([0.0, 0.0], [0.0, side * 40.0])
    assert motion.speed == 0.0
    assert np.sign(motion.yaw_rate) == side


def test_the_law_does_not_depend_on_the_worlds_axes():
    turn = 1.234
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    reference, force = np.array([1.0, 0.4]), np.array([5.0, -20.0])
    one_reference, one = step(reference, force, 0.3, 1.1)
    other_reference, other = step(rotation @ reference, rotation @ force, 0.3 + turn, 1.1)
    np.testing.assert_allclose(other_reference, rotation @ one_reference, atol=1e-12)
    for name in ("speed", "acceleration", "yaw_rate"):
        assert getattr(other, name) == pytest.approx(getattr(one, name), abs=1e-12)


def test_the_yaw_rate_is_limited():
    _, motion = step([0.0, 9.0], [0.0, 50.0])
    assert motion.yaw_rate == GAINS.yaw_rate_limit


def test_with_hold_c_over_m_the_reference_is_the_point_mass():
    # F = f - c v on the robot's velocity v: the two terms in v cancel, and v_ref obeys m dv/dt = f - c v_ref.
    c, f, speed = 13.0, 30.0, 0.7
    reference, _ = steer(
        np.array([1.0, 0.0]),
        np.array([f - c * speed, 0.0]),
        np.array(0.0),
        np.array(speed),
        mass=MASS,
        period=PERIOD,
        gains=HandPoint(hold=c / MASS),
    )
    exact = f / c + (1.0 - f / c) * np.exp(-c / MASS * PERIOD)
    assert reference[0] == pytest.approx(exact, rel=1e-12)
