import numpy as np
import pytest

from dynabot_mj.common.exceptions import DynabotError
from dynabot_mj.common.streams import Purpose
from dynabot_mj.experiments.estimators import tether
from dynabot_mj.experiments.estimators.tether import Profile, drive
from dynabot_mj.plants import scene

SEED = 3
STEADY = 9.0  # after two seconds at the speed that is told [s]


@pytest.fixture(scope="module")
def circling():
    return drive(range(6), SEED, 24.0)


@pytest.fixture(scope="module")
def steady(circling):
    return circling.time > STEADY


def polar(vector_w):
    return np.linalg.norm(vector_w, axis=-1), np.unwrap(np.arctan2(vector_w[..., 1], vector_w[..., 0]), axis=0)


def side_slip(truth):
    """Returns the angle from the heading to the velocity, (K, R) [rad]."""
    angle = polar(truth.velocity_w)[1] - truth.heading
    return (angle + np.pi) % (2.0 * np.pi) - np.pi


def mean_felt(truth, steady):
    """Returns the mean of what the accelerometers feel in a span, (R, 2) [m/s^2]."""
    time, impulse_b = truth.time[steady], truth.velocity_increment_b[steady]
    return (impulse_b[-1] - impulse_b[0]) / (time[-1] - time[0])


def test_the_grid_is_even_and_reaches_the_end(circling):
    assert circling.runs == 6
    np.testing.assert_allclose(np.diff(circling.time), tether.INTERVAL, rtol=1e-9)
    assert (circling.time[0], circling.interval) == (0.0, pytest.approx(0.009))
    assert 24.0 <= circling.time[-1] < 24.0 + 0.036
    for name, shape in (
        ("wheel_speed", (4,)),
        ("motor_current", (4,)),
        ("velocity_increment_b", (2,)),
        ("heading", ()),
    ):
        assert getattr(circling, name).shape == (len(circling.time), 6, *shape)


def test_it_circles_at_seven_metres_and_three_metres_per_second(circling, steady):
    radius, bearing = polar(circling.position_w[steady])
    np.testing.assert_allclose(radius, 7.0, atol=2e-3)
    assert radius.std() < 1e-3
    speed, _ = polar(circling.velocity_w[steady])
    np.testing.assert_allclose(speed, 3.0, rtol=0.01)  # the law has no integral
    # Counter-clockwise, and nothing swings.
    assert (np.diff(bearing, axis=0) > 0.0).all()
    np.testing.assert_allclose(circling.yaw_rate[steady], speed / radius, rtol=1e-3)
    assert circling.yaw_rate[steady].std(axis=0).max() < 1e-3


def test_the_tether_is_taut_once_the_robot_has_pulled_it_so(circling):
    model = scene.compose_tethered().compile()
    ahead, length = model.site("tether/hitch").pos[0], model.tendon_range[0, 1]
    hitch_w = circling.position_w + ahead * np.stack([np.cos(circling.heading), np.sin(circling.heading)], axis=-1)
    distance, _ = polar(hitch_w)
    taut = distance > length
    assert not taut[circling.time <= 4.0].any()
    assert taut[circling.time > 5.5].all()
    # At most the stretch of a pull of 60 N on what resists there, about 12 kg x 2,000 / s^2.
    assert (distance - length).max() < 60.0 / (12.0 * 2000.0)


def test_it_rests_first_and_then_accelerates_as_told(circling):
    before = circling.time <= 4.0
    np.testing.assert_allclose(circling.velocity_w[before], 0.0, atol=1e-4)
    # The start is the place of rest but for some nanometres, so nothing is felt.
    assert np.abs(circling.velocity_increment_b[before]).max() < 1e-3
    speed, _ = polar(circling.velocity_w)
    half_way = np.searchsorted(circling.time, 5.5)
    np.testing.assert_allclose(speed[half_way], 1.5, atol=0.05)


def test_accelerometers_feel_the_centripetal_acceleration(circling, steady):
    speed, slip = polar(circling.velocity_w[steady])[0].mean(axis=0), side_slip(circling)[steady].mean(axis=0)
    felt_b = mean_felt(circling, steady)
    # v^2 / R across the velocity, which points off the heading. A tilt of 0.2 degrees leaks 0.034 m/s^2 of gravity.
    leak = 9.81 * np.deg2rad(0.2)
    np.testing.assert_allclose(felt_b[:, 0], -(speed**2) / 7.0 * np.sin(slip), atol=leak)
    np.testing.assert_allclose(felt_b[:, 1], speed**2 / 7.0 * np.cos(slip), atol=leak)
    # The nose points outward, by the slip that the tether's length reckons with.
    np.testing.assert_allclose(np.rad2deg(slip), 1.0, atol=0.1)


def test_position_and_heading_are_the_integrals_of_their_rates(circling):
    for place, rate in ((circling.position_w, circling.velocity_w), (circling.heading, circling.yaw_rate)):
        way = np.cumsum(0.5 * (rate[1:] + rate[:-1]), axis=0) * circling.interval
        # Euler's position is half a physics step behind that of the trapezium: 2.25 ms of the change of the rate.
        np.testing.assert_allclose(place[1:] - place[0], way, atol=0.5 * 0.0045 * 2.0 * np.abs(rate).max())


def test_outer_wheels_are_driven_and_inner_ones_held_back(circling, steady):
    left, right = slice(0, None, 2), slice(1, None, 2)
    assert (circling.motor_current[steady][..., right] > 1.0).all()
    assert (circling.motor_current[steady][..., left] < -1.0).all()
    rolling = 3.0 / scene.read_robot().vehicle.wheel_radius
    np.testing.assert_allclose(circling.wheel_speed[steady].mean(), rolling, rtol=0.01)
    assert np.abs(circling.motor_current).max() <= scene.read_robot().vehicle.current_limit


def test_golden_run():
    truth = drive([0], SEED, 8.0)
    np.testing.assert_allclose(truth.position_w[-1, 0], [5.71307, 4.04514], atol=1e-4)
    assert truth.heading[-1, 0] == pytest.approx(2.16915, abs=1e-4)
    np.testing.assert_allclose(truth.velocity_increment_b[-1, 0], [2.99883, 2.57173], atol=1e-4)
    np.testing.assert_allclose(truth.motor_current[-1, 0], [-1.633, 2.384, -2.221, 3.089], atol=1e-2)


def test_a_run_depends_on_its_number_alone(monkeypatch):
    monkeypatch.setattr(tether, "_CHUNK", 2)
    shares = []
    together = drive(range(3), SEED, 5.0, threads=2, progress=shares.append)
    assert shares == [2.0 / 3.0, 1.0]
    alone = drive([2], SEED, 5.0)
    for name in ("position_w", "heading", "velocity_increment_b", "motor_current"):
        np.testing.assert_array_equal(getattr(together, name)[:, 2], getattr(alone, name)[:, 0])
    assert not np.array_equal(drive([2], SEED + 1, 0.1).position_w, alone.position_w[:13])


def test_friction_and_start_are_drawn_evenly():
    friction = tether._uniform(0, range(400), Purpose.FRICTION, (0.6, 0.9))
    assert 0.6 <= friction.min() < 0.605
    assert 0.895 < friction.max() < 0.9
    assert friction.mean() == pytest.approx(0.75, abs=4.0 * 0.3 / np.sqrt(12.0 * 400))
    start = drive(range(30), 0, 0.1)
    radius, bearing = polar(start.position_w[0])
    np.testing.assert_allclose(radius, radius[0])
    facing = (start.heading[0] - bearing - np.pi / 2.0 + np.pi) % (2.0 * np.pi) - np.pi
    np.testing.assert_allclose(facing, 0.0, atol=1e-9)
    assert np.ptp(bearing % (2.0 * np.pi)) > 5.0


def test_another_profile_is_driven():
    truth = drive([0], SEED, 6.0, profile=Profile(rest=1.0, acceleration=0.5, speed=1.0))
    np.testing.assert_allclose(polar(truth.velocity_w[-1])[0], 1.0, rtol=0.02)


def test_a_run_that_breaks_down_is_told(monkeypatch):
    def place(qpos, bearing, radius):
        qpos[:] = np.nan

    monkeypatch.setattr(tether, "_place", place)
    with pytest.raises(DynabotError, match="seed 3: MuJoCo met a NaN"):
        drive([0], SEED, 0.1)
