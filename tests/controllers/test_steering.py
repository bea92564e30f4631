import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from dynabot_mj.controllers import axes
from dynabot_mj.controllers.steering import HandPoint, Heading, Reference, rest, steer

SHARED = {
    "hold": 1.5,
    "catch_up": 0.4,
    "forget": 0.2,
    "farthest": 1.0,
    "preview": 0.1,
    "yaw_rate_limit": 3.0,
    "deadband": 0.01,
}
HAND_POINT = HandPoint(**SHARED, offset=0.35, turning_speed=0.8)
HEADING = Heading(**SHARED, heading_gain=4.0)
LAWS = pytest.mark.parametrize("gains", [HAND_POINT, HEADING], ids=["hand-point", "heading"])
MASS, PERIOD = 12.0, 0.036


def reference(velocity=(0.0, 0.0), lag=(0.0, 0.0)):
    return Reference(velocity_w=np.array(velocity, float), lag_w=np.array(lag, float))


def step(before, force, heading=0.0, speed=0.0, gains=HAND_POINT):
    return steer(
        before,
        np.array(force, float),
        axes.of_heading(np.array(heading, float)),
        np.array(speed, float),
        mass=MASS,
        period=PERIOD,
        gains=gains,
    )


def unit(angle):
    return np.array([np.cos(angle), np.sin(angle)])


@LAWS
def test_rest_without_force_stays_rest(gains):
    after, motion = step(rest(()), [0.0, 0.0], gains=gains)
    np.testing.assert_array_equal(after.velocity_w, 0.0)
    np.testing.assert_array_equal(after.lag_w, 0.0)
    assert motion.speed == motion.yaw_rate == motion.acceleration == 0.0


def test_the_reference_integrates_its_equation_under_a_held_force():
    before, force, heading, speed = reference([1.0, -0.5]), np.array([20.0, -7.0]), 0.6, 1.3
    after, _ = step(before, force, heading, speed)
    steps, euler = 4000, before.velocity_w
    for _ in range(steps):
        euler = euler + PERIOD / steps * (force / MASS + HAND_POINT.hold * (speed * unit(heading) - euler))
    np.testing.assert_allclose(after.velocity_w, euler, rtol=1e-6)


def test_the_lag_integrates_its_equation():
    # Fast enough to show, over many short periods, against Euler's method with steps a hundred times shorter.
    gains = replace(HAND_POINT, forget=2.0)
    speed, force, heading, steps, fine = 0.2, np.array([6.0, 3.0]), 0.3, 200, 100
    now, v, lag = rest(()), np.zeros(2), np.zeros(2)
    for _ in range(steps):
        now, _ = step(now, force, heading, speed, gains)
    for _ in range(steps * fine):
        lag = lag + PERIOD / fine * (v - speed * unit(heading) - gains.forget * lag)
        v = v + PERIOD / fine * (force / MASS + gains.hold * (speed * unit(heading) - v))
    # Of first order in the period: f T / 2 and more at the start, k T.
    np.testing.assert_allclose(now.lag_w, lag, rtol=gains.forget * PERIOD)


def test_with_hold_c_over_m_the_reference_is_the_point_mass_whatever_the_robot_does():
    # F = f - c v on the robot's velocity v: the two terms in v cancel, and v_ref obeys m dv/dt = f - c v_ref.
    c, random = 13.0, np.random.default_rng(0)
    gains = replace(HAND_POINT, hold=c / MASS, catch_up=0.0, preview=0.0)
    now, particle = rest(()), np.zeros(2)
    for _ in range(200):
        f, heading, speed = random.uniform(-40.0, 40.0, 2), random.uniform(-np.pi, np.pi), random.uniform(-3.0, 3.0)
        now, motion = step(now, f - c * speed * unit(heading), heading, speed, gains)
        particle = f / c + (particle - f / c) * np.exp(-c / MASS * PERIOD)
        np.testing.assert_allclose(now.velocity_w, particle, atol=1e-12)
        if np.linalg.norm(particle) > gains.deadband:
            assert motion.speed == pytest.approx(particle @ unit(heading), abs=1e-12)


@LAWS
def test_a_force_ahead_asks_for_the_point_masss_speed(gains):
    after, motion = step(rest(()), [24.0, 0.0], gains=replace(gains, catch_up=0.0, preview=0.0))
    # F T / m but for the pull to the robot's rest, of second order: k T / 2 of it.
    assert motion.speed == pytest.approx(24.0 * PERIOD / MASS, rel=gains.hold * PERIOD)
    assert motion.acceleration == pytest.approx(2.0)
    assert motion.yaw_rate == 0.0
    assert after.velocity_w[1] == 0.0


@LAWS
def test_the_preview_adds_what_the_reference_gains_in_that_time(gains):
    none, some = (
        step(rest(()), [24.0, 0.0], gains=replace(gains, catch_up=0.0, preview=preview))[1].speed
        for preview in (0.0, 0.05)
    )
    # d v_ref / dt is F / m at first, and has fallen by e^(-k T) after the period.
    assert some - none == pytest.approx(0.05 * 2.0 * math.exp(-gains.hold * PERIOD))


@LAWS
def test_a_remembered_lag_is_made_up_for(gains):
    # At the reference's speed and without force, q times what is left of the lag comes on top.
    _, motion = step(reference([1.0, 0.0], [0.5, 0.0]), [0.0, 0.0], speed=1.0, gains=gains)
    assert motion.speed == pytest.approx(1.0 + gains.catch_up * 0.5 * math.exp(-gains.forget * PERIOD))


@LAWS
def test_a_force_behind_asks_for_reversing_without_turning(gains):
    _, motion = step(rest(()), [-24.0, 0.0], gains=gains)
    assert motion.speed < 0.0
    assert motion.yaw_rate == 0.0


@LAWS
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_lateral_force_at_rest_turns_the_robot_toward_it(gains, side):
    _, motion = step(rest(()), [0.0, side * 40.0], gains=gains)
    assert motion.speed == 0.0
    assert motion.acceleration == 0.0
    assert np.sign(motion.yaw_rate) == side


def test_the_hand_point_turns_round_for_a_force_almost_behind():
    _, motion = step(rest(()), 24.0 * unit(np.radians(175.0)))
    assert motion.speed < 0.0
    assert motion.yaw_rate > 0.0  # the shorter way


@pytest.mark.parametrize("angle", [-100.0, -170.0, 100.0, 170.0])
def test_the_heading_law_reverses_for_forces_behind(angle):
    _, motion = step(rest(()), 24.0 * unit(np.radians(angle)), gains=replace(HEADING, heading_gain=1.0))
    assert motion.speed < 0.0
    # The rear end turns into the force: by the angle from the back.
    assert motion.yaw_rate == pytest.approx(np.radians(angle - math.copysign(180.0, angle)))


def test_the_heading_law_turns_by_gain_times_angle():
    _, motion = step(rest(()), 24.0 * unit(0.2), gains=HEADING)
    assert motion.yaw_rate == pytest.approx(4.0 * 0.2)


def test_the_hand_point_moves_with_what_is_wanted():
    # At rest and without the turning term: yaw_rate = u . e_y / l.
    gains = replace(HAND_POINT, turning_speed=1e6)
    after, motion = step(rest(()), 12.0 * unit(0.4), gains=gains)
    u = after.velocity_w + gains.catch_up * after.lag_w
    u = u + gains.preview * (12.0 * unit(0.4) / MASS - gains.hold * after.velocity_w)
    assert motion.speed == pytest.approx(u[0])
    assert motion.yaw_rate == pytest.approx(u[1] / gains.offset, rel=1e-9)


def test_the_turning_term_is_the_rate_of_the_references_direction():
    # Fast compared with v0, on a circle: v_ref along the heading, its derivative across, both known.
    gains = replace(HAND_POINT, turning_speed=1e-3, preview=0.0, catch_up=0.0, hold=1e-6)
    force = np.array([0.0, 12.0])
    after, motion = step(reference([3.0, 0.0]), force, 0.0, 3.0, gains)
    across = after.velocity_w[1] / gains.offset
    assert motion.yaw_rate - across == pytest.approx(1.0 / 3.0, rel=1e-4)


@LAWS
def test_below_the_deadband_the_robot_is_told_to_rest(gains):
    still = replace(gains, deadband=0.1)
    for angle in np.linspace(-np.pi, np.pi, 13):
        _, motion = step(rest(()), 1.0 * unit(angle), gains=still)
        assert motion.speed == motion.yaw_rate == motion.acceleration == 0.0
    assert step(rest(()), [40.0, 0.0], gains=still)[1].speed > 0.0


@LAWS
def test_the_yaw_rate_is_limited(gains):
    for side in (1.0, -1.0):
        _, motion = step(reference([0.0, side * 9.0]), [0.0, side * 50.0], gains=gains)
        assert motion.yaw_rate == side * gains.yaw_rate_limit


@LAWS
@given(
    turn=st.floats(-4.0, 4.0),
    heading=st.floats(-4.0, 4.0),
    speed=st.floats(-3.0, 3.0),
    values=st.lists(st.floats(-4.0, 4.0), min_size=6, max_size=6),
)
def test_the_laws_do_not_depend_on_the_worlds_axes(gains, turn, heading, speed, values):
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    velocity, lag, force = np.array(values[:2]), np.array(values[2:4]) / 8.0, 10.0 * np.array(values[4:])
    one_after, one = step(reference(velocity, lag), force, heading, speed, gains)
    # Where the wanted velocity points exactly sideways, rounding decides which end of the robot is the nearer one.
    assume(abs(one.speed) > 1e-6)
    other_after, other = step(
        reference(rotation @ velocity, rotation @ lag), rotation @ force, heading + turn, speed, gains
    )
    np.testing.assert_allclose(other_after.velocity_w, rotation @ one_after.velocity_w, atol=1e-9)
    np.testing.assert_allclose(other_after.lag_w, rotation @ one_after.lag_w, atol=1e-9)
    for name in ("speed", "acceleration", "yaw_rate"):
        assert getattr(other, name) == pytest.approx(getattr(one, name), abs=1e-6)


@LAWS
@given(heading=st.floats(-4.0, 4.0), angle=st.floats(-4.0, 4.0), force=st.floats(0.0, 50.0))
def test_a_blocked_robot_does_not_wind_up(gains, heading, angle, force):
    now, bound = rest(()), force / (MASS * gains.hold)
    for _ in range(400):
        now, motion = step(now, force * unit(angle), heading, 0.0, gains)
        assert np.linalg.norm(now.velocity_w) <= bound + 1e-12
        assert np.linalg.norm(now.lag_w) <= gains.farthest + 1e-12
        most = bound + gains.catch_up * gains.farthest + gains.preview * force / MASS
        assert abs(motion.speed) <= most + 1e-9
    # Released, the reference turns round with the force within ln 2 / k of its reversal.
    for _ in range(math.ceil(math.log(2.0) / gains.hold / PERIOD)):
        now, _ = step(now, -force * unit(angle), heading, 0.0, gains)
    assert now.velocity_w @ unit(angle) <= 1e-12


def test_the_lag_is_bounded_and_forgotten():
    now = rest(())
    for _ in range(1000):
        now, _ = step(now, [40.0, 0.0])
    assert np.linalg.norm(now.lag_w) == pytest.approx(HAND_POINT.farthest)
    # Without force, at the reference's own speed (none), nothing is added.
    now = now._replace(velocity_w=np.zeros(2))
    for _ in range(100):
        now, _ = step(now, [0.0, 0.0])
    assert now.lag_w[0] == pytest.approx(HAND_POINT.farthest * math.exp(-HAND_POINT.forget * 100 * PERIOD))


def test_no_memory_means_no_lag():
    now, _ = step(rest(()), [40.0, 0.0], gains=replace(HAND_POINT, farthest=0.0))
    np.testing.assert_array_equal(now.lag_w, 0.0)


@LAWS
def test_robots_in_an_array_are_what_each_is_alone(gains):
    random = np.random.default_rng(3)
    velocity, lag, force = (random.uniform(-1.0, 1.0, (2, 2, 3)) for _ in range(3))  # components first
    heading, speed = random.uniform(-3.0, 3.0, (2, 3)), random.uniform(-2.0, 2.0, (2, 3))
    together, motions = step(Reference(velocity_w=velocity, lag_w=lag), 30.0 * force, heading, speed, gains)
    for at in np.ndindex(2, 3):
        one = (..., *at)
        alone, motion = step(reference(velocity[one], lag[one]), 30.0 * force[one], heading[at], speed[at], gains)
        np.testing.assert_allclose(together.lag_w[one], alone.lag_w, atol=1e-15)
        assert motions.yaw_rate[at] == pytest.approx(float(motion.yaw_rate), abs=1e-14)
