import math
from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.controllers.vehicle import GRAVITY
from dynabot_mj.plants.plant import FleetState
from dynabot_mj.sensing.options import GpsErrors, GroundErrors, ImuErrors, MagnetometerErrors, SensorOptions
from dynabot_mj.sensing.sensors import Sensors

PERIOD = 0.036
IDEAL = SensorOptions(
    gps=GpsErrors(stamp_error=0.0, position_noise=0.0, position_bias=0.0, velocity_noise=0.0, velocity_bias=0.0),
    imu=ImuErrors(
        acceleration_density=0.0,
        acceleration_bias=0.0,
        acceleration_drift=0.0,
        acceleration_scale=0.0,
        yaw_rate_density=0.0,
        yaw_rate_bias=0.0,
        yaw_rate_drift=0.0,
        yaw_rate_scale=0.0,
    ),
    magnetometer=MagnetometerErrors(noise=0.0, hard_iron=0.0, soft_iron=0.0, motors=0.0),
    ground=GroundErrors(unevenness=0.0, slope=0.0),
)


def moving(time, trials=1, robots=1):
    """Along x with 1 m/s^2, turning with 0.5 rad/s; the accelerometer ahead integrates to the time."""
    shape = (trials, robots)
    along = np.array([1.0, 0.0])
    return FleetState(
        time=time,
        position_w=np.broadcast_to(0.5 * time**2 * along, (*shape, 2)),
        velocity_w=np.broadcast_to(time * along, (*shape, 2)),
        heading=np.full(shape, 0.5 * time),
        yaw_rate=np.full(shape, 0.5),
        velocity_increment_b=np.broadcast_to(time * along, (*shape, 2)),
    )


def still(time, trials=1, robots=1):
    return replace(moving(0.0, trials, robots), time=time)


def sampled(sensors, state, count, *, period=PERIOD, due=None):
    """Yields the samples at the next times of a motion, looked at three times in each period."""
    for index in range(count):
        for look in range(3 if index else 0, 0, -1):
            sensors.substep(state(period * (index - look / 3.0)))
        now = state(period * index)
        sensors.substep(now)
        yield sensors.sample(now, np.ones(now.heading.shape, dtype=bool) if due is None else due)


def test_ideal_sensors_tell_the_truth():
    sensors = Sensors(IDEAL, PERIOD, 0, [0], moving(0.0))
    samples = list(sampled(sensors, moving, 30))
    first, _ = samples[0]
    assert first.period[0, 0] == 0.0
    for index, (imu, _) in enumerate(samples[1:], 1):
        assert imu.period[0, 0] == pytest.approx(PERIOD)
        np.testing.assert_allclose(imu.specific_force_b[0, 0], [1.0, 0.0], atol=1e-9)
        assert imu.yaw_rate[0, 0] == pytest.approx(0.5)
        assert imu.magnetic_heading[0, 0] == pytest.approx(0.5 * PERIOD * index)


def test_fixes_are_latched_when_they_are_true_and_arrive_later():
    sensors = Sensors(IDEAL, PERIOD, 0, [0], moving(0.0))
    seen = []
    for index, (_, fix) in enumerate(sampled(sensors, moving, 30)):
        if fix.received[0, 0]:
            now = PERIOD * index
            seen.append(true_at := now - fix.age[0, 0])
            assert fix.age[0, 0] >= 0.15 - 1e-9  # the latency
            assert fix.age[0, 0] < 0.15 + PERIOD + 1e-9
            # Linear interpolation over 12 ms at 1 m/s^2 is wrong by (12 ms)^2 / 8 at most.
            assert fix.position_w[0, 0, 0] == pytest.approx(0.5 * true_at**2, abs=1.9e-5)
            assert fix.velocity_w[0, 0, 0] == pytest.approx(true_at, abs=1e-9)
    np.testing.assert_allclose(seen, 0.2 * np.arange(len(seen)), atol=1e-9)
    assert len(seen) == 5


def test_a_stamp_that_is_late_makes_fixes_look_younger():
    late = replace(IDEAL, gps=replace(IDEAL.gps, stamp_error=0.03))
    exact, wrong = (
        [fix.age[0, 0] for _, fix in sampled(Sensors(options, PERIOD, 0, [0], moving(0.0)), moving, 30)]
        for options in (IDEAL, late)
    )
    arrived = np.isfinite(exact)
    assert arrived.any()
    np.testing.assert_allclose(np.array(exact)[arrived] - np.array(wrong)[arrived], 0.03)


def test_a_robot_that_is_not_due_gets_its_fix_later_and_longer_averages():
    sensors = Sensors(IDEAL, PERIOD, 0, [0], moving(0.0, robots=2))
    due = np.array([[True, False]])
    early = list(sampled(sensors, lambda time: moving(time, robots=2), 10, due=due))
    assert sum(fix.received[0, 0] for _, fix in early) == 1
    assert not any(fix.received[0, 1] for _, fix in early)
    now = moving(10 * PERIOD, robots=2)
    sensors.substep(now)
    imu, fix = sensors.sample(now, np.ones((1, 2), dtype=bool))
    assert fix.received.tolist() == [[True, True]] or fix.received.tolist() == [[False, True]]
    np.testing.assert_allclose(imu.period, [[PERIOD, 10 * PERIOD]])
    np.testing.assert_allclose(imu.specific_force_b[0, 1], [1.0, 0.0], atol=1e-9)


@pytest.mark.parametrize("period", [0.036, 0.156])
def test_white_noise_has_its_density_whatever_the_period(period):
    options = replace(IDEAL, imu=replace(IDEAL.imu, acceleration_density=0.05, yaw_rate_density=0.002))
    sensors = Sensors(options, period, 3, range(200), still(0.0, 200))
    draws = [imu for imu, _ in sampled(sensors, lambda time: still(time, 200), 41, period=period)][1:]
    force = np.stack([imu.specific_force_b for imu in draws])
    turn = np.stack([imu.yaw_rate for imu in draws])
    # The mean square of N normals is within 4.5 sqrt(2 / N) of their variance, but for 7 in a million cases.
    for values, density in ((force, 0.05), (turn, 0.002)):
        assert (values**2).mean() == pytest.approx(density**2 / period, rel=4.5 * math.sqrt(2.0 / values.size))


def test_one_degree_of_slope_leaks_gravity_in_one_direction_of_the_ground():
    options = replace(IDEAL, ground=GroundErrors(unevenness=0.0, slope=math.radians(1.0)))
    state = still(0.0, 50)
    sensors = Sensors(options, PERIOD, 0, range(50), state)
    headings = []
    for index, angle in enumerate((0.0, 0.0, math.pi, math.pi)):
        now = replace(state, time=PERIOD * index, heading=np.full((50, 1), angle))
        sensors.substep(now)
        imu, _ = sensors.sample(now, np.ones((50, 1), dtype=bool))
        headings.append(imu.specific_force_b)
    leak = np.hypot(headings[1][..., 0], headings[1][..., 1])
    np.testing.assert_allclose(leak, GRAVITY * math.sin(math.radians(1.0)))
    np.testing.assert_allclose(leak, 0.171, atol=1e-3)  # findings: 0.17 m/s^2 per degree
    np.testing.assert_allclose(headings[3], -headings[1], atol=1e-12)  # the robot has turned, the ground has not


def test_iron_draws_the_bearing_off_once_and_twice_per_turn():
    options = replace(IDEAL, magnetometer=MagnetometerErrors(noise=0.0, hard_iron=0.1, soft_iron=0.03, motors=0.0))
    state = still(0.0, 20)
    sensors = Sensors(options, PERIOD, 0, range(20), state)
    errors = []
    turn = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    for index, angle in enumerate(turn):
        now = replace(state, time=PERIOD * index, heading=np.full((20, 1), angle))
        imu, _ = sensors.sample(now, np.ones((20, 1), dtype=bool))
        errors.append((imu.magnetic_heading[:, 0] - angle + np.pi) % (2.0 * np.pi) - np.pi)
    spectrum = np.abs(np.fft.rfft(np.array(errors), axis=0)) * 2.0 / len(turn)
    np.testing.assert_allclose(spectrum[1], 0.1, atol=1e-9)
    np.testing.assert_allclose(spectrum[2], 0.03, atol=1e-9)
    np.testing.assert_allclose(spectrum[3:], 0.0, atol=1e-9)


@pytest.mark.parametrize(("common", "expected"), [(0.0, 0.0), (0.5, 0.5), (1.0, 1.0)])
def test_a_share_of_the_gps_bias_is_common_to_all_robots(common, expected):
    options = replace(IDEAL, gps=replace(IDEAL.gps, position_bias=0.75, common=common))
    trials = 2000
    sensors = Sensors(options, PERIOD, 1, range(trials), still(0.0, trials, 2))
    slow = sensors.slow_errors[..., 3:]
    # 4,000 pairs: means of squares and products are within 4.5 sqrt(2 / N) of what they should be.
    bound = 4.5 * math.sqrt(2.0 / 4000)
    assert (slow**2).mean() == pytest.approx(0.75**2, rel=bound)
    assert (slow[:, 0] * slow[:, 1]).mean() == pytest.approx(expected * 0.75**2, abs=bound * 0.75**2)


def test_slow_errors_keep_their_size_and_forget():
    options = replace(IDEAL, gps=replace(IDEAL.gps, position_bias=0.75, position_bias_time=2.0))
    trials = 1000
    sensors = Sensors(options, PERIOD, 1, range(trials), still(0.0, trials))
    before = sensors.slow_errors[..., 3:]
    for _ in sampled(sensors, lambda time: still(time, trials), 58):  # 2.052 s, 11 fixes from 0 to 2.0 s
        pass
    after = sensors.slow_errors[..., 3:]
    bound = 4.5 * math.sqrt(2.0 / (2 * trials))
    assert (after**2).mean() == pytest.approx(0.75**2, rel=bound)
    # Eleven steps of 0.2 s at a correlation time of 2 s.
    assert (before * after).mean() == pytest.approx(math.exp(-1.1) * 0.75**2, abs=bound * 0.75**2)


def test_the_errors_of_a_period_are_known_when_it_begins():
    sensors = Sensors(SensorOptions(), PERIOD, 0, range(3), still(0.0, 3))
    due = np.ones((3, 1), dtype=bool)
    sensors.sample(still(0.0, 3), due)
    force, turn = sensors.force_error_b.copy(), sensors.yaw_rate_error.copy()
    imu, _ = sensors.sample(still(PERIOD, 3), due)
    # At rest there is nothing else to measure, but for the scale of the slope's leak: 3 % of 0.08 m/s^2.
    np.testing.assert_allclose(imu.specific_force_b, force, atol=4.0 * 0.03 * 0.08)
    np.testing.assert_allclose(imu.yaw_rate, turn, atol=1e-12)


def test_a_trial_does_not_depend_on_the_others():
    def last(trials):
        sensors = Sensors(SensorOptions(), PERIOD, 5, trials, still(0.0, len(trials), 2))
        *_, (imu, fix) = sampled(sensors, lambda time: still(time, len(trials), 2), 20)
        return imu.specific_force_b[-1], imu.magnetic_heading[-1], fix.position_w[-1]

    for alone, together in zip(last([7]), last([3, 4, 7]), strict=True):
        np.testing.assert_array_equal(alone, together)


@pytest.mark.parametrize("period", [0.027, 0.156])
def test_uneven_ground_leaks_the_mean_of_its_tilt_over_the_period(period):
    """Its root mean square is sigma sqrt(2 (x - 1 + e^-x)) / x; that of the mean of both ends is up to 3 % less."""
    ground = GroundErrors(slope=0.0)
    sensors = Sensors(replace(IDEAL, ground=ground), period, 0, range(300), start := still(0.0, trials=300, robots=2))
    leaks = []
    for index in range(61):
        state = replace(start, time=index * period)
        sensors.substep(state)
        leaks.append(sensors.sample(state, np.ones((300, 2), dtype=bool))[0].specific_force_b)
    measured = np.array(leaks[1:])  # the first is an average over no time
    x = period / ground.unevenness_time
    expected = GRAVITY * ground.unevenness * math.sqrt(2.0 * (x - 1.0 + math.exp(-x))) / x
    # 1,200 independent sequences of 60 periods. With the correlation rho of successive means, at most e^-x (1 + x), a
    # sequence's mean square has a relative variance of 2 (1 + rho^2) / (1 - rho^2) / 60 = 0.4 at 27 ms and 0.1 at
    # 156 ms: the root mean square is known within 0.9 and 0.46 %, of which 4.5 would hide the 0.7 % at 27 ms, but not
    # the 3 % at 156 ms.
    spread = {0.027: 0.009, 0.156: 0.0046}[period]
    assert np.sqrt((measured**2).mean()) == pytest.approx(expected, rel=4.5 * spread)
