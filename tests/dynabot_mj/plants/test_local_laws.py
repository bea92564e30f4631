import numpy as np
import pytest

from dynabot_mj.controllers import gains
from dynabot_mj.plants import scene
from dynabot_mj.plants.local_laws import Drivers, LocalLaws
from dynabot_mj.plants.plant import FleetState, NavigationError

TUNED = gains.load("tuned")
PERIOD = 0.03


def state(time, velocity=(0.0, 0.0), heading=0.0):
    return FleetState(
        time=time,
        position_w=np.zeros((1, 1, 2)),
        velocity_w=np.array([[velocity]]),
        heading=np.full((1, 1), heading),
        yaw_rate=np.zeros((1, 1)),
        velocity_increment_b=np.zeros((1, 1, 2)),
    )


def drivers(**options):
    laws = LocalLaws(steering=TUNED.hand_point, traction=TUNED.traction, **options)
    return Drivers(laws, scene.read_robot().vehicle, state(0.0))


def drive(driver, state, force, wheel_speed=0.0, error=None, spin=0.0):
    wheel_speeds = np.full((1, 1, 4), wheel_speed)
    speed, torque = driver.drive(np.array([[force]]), state, np.full((1, 1), spin), wheel_speeds, PERIOD, error)
    return speed[0, 0], torque[0, 0]


def navigation_error(heading=0.0, yaw_rate=0.0, acceleration=None):
    acceleration_b = None if acceleration is None else np.array([[acceleration]])
    return NavigationError(
        heading=np.full((1, 1), heading), yaw_rate=np.full((1, 1), yaw_rate), acceleration_b=acceleration_b
    )


def test_a_force_ahead_turns_all_wheels_alike_and_ahead():
    speed, torque = drive(drivers(), state(0.0), (20.0, 0.0))
    assert np.ptp(speed) == pytest.approx(0.0, abs=1e-12)
    assert np.ptp(torque) == pytest.approx(0.0, abs=1e-12)
    assert torque[0] > 0.0


def test_a_force_to_the_left_turns_the_robot_left():
    speed, _ = drive(drivers(), state(0.0), (0.0, 20.0))
    assert speed[1] > speed[0]
    assert speed[3] > speed[2]


def test_odometry_carries_the_measured_acceleration_on():
    driver, radius = drivers(), scene.read_robot().vehicle.wheel_radius
    drive(driver, state(0.0), (20.0, 0.0))
    drive(driver, state(PERIOD, (0.05, 0.0)), (20.0, 0.0), wheel_speed=0.05 / radius)
    assert driver.odometry_w[0, 0] == pytest.approx([0.05, 0.0])


def test_with_true_sensing_odometry_does_not_matter():
    """On board, a robot that starts to be observed in motion is thought to be at rest."""

    def commands(on_board):
        return drive(drivers(on_board=on_board), state(0.0, (2.0, 0.0)), (0.0, 0.0))[0]

    assert commands(True).mean() < commands(False).mean()


def test_the_heading_that_laws_steer_by_is_the_believed_one():
    quarter = np.pi / 2.0
    believed = drive(drivers(), state(0.0), (20.0, 0.0), error=navigation_error(heading=quarter))
    true = drive(drivers(), state(0.0, heading=quarter), (20.0, 0.0))
    np.testing.assert_allclose(believed, true)


def test_the_yaw_rate_that_laws_correct_is_the_gyros():
    measured, _ = drive(drivers(), state(0.0), (20.0, 0.0), spin=0.3, error=navigation_error(yaw_rate=0.2))
    turning_as_fast, _ = drive(drivers(), state(0.0), (20.0, 0.0), spin=0.5)
    turning_slower, _ = drive(drivers(), state(0.0), (20.0, 0.0), spin=0.3)
    np.testing.assert_allclose(measured, turning_as_fast)
    assert np.abs(measured - turning_slower).max() > 0.01


def test_odometry_feels_the_accelerometers_error_on_the_way_that_the_robot_turned_meanwhile():
    """Its error of 1 m/s^2 ahead, in a turn with 2 rad/s that a gyro is off by, is felt along the heading half-way."""
    driver, error = drivers(), navigation_error(yaw_rate=2.0, acceleration=(1.0, 0.0))
    drive(driver, state(0.0), (0.0, 0.0), error=error)
    drive(driver, state(PERIOD), (0.0, 0.0), error=error, spin=2.0)
    half_way = -0.5 * PERIOD * (2.0 + 2.0)
    ahead, left = driver.odometry_w[0, 0]
    felt = PERIOD * np.array([np.cos(half_way), np.sin(half_way)])
    # Wheels at rest and a robot that is not thought to slide sideways pull each part toward zero, left no more than so.
    assert 0.0 < ahead < felt[0]
    assert felt[1] <= left < 0.0
    undisturbed = drivers()
    drive(undisturbed, state(0.0), (0.0, 0.0))
    drive(undisturbed, state(PERIOD), (0.0, 0.0), spin=2.0)
    np.testing.assert_array_equal(undisturbed.odometry_w, 0.0)


def test_real_wheels_are_read_with_their_resolution():
    def odometry(wheel_speed, error):
        driver = drivers(wheel_resolution=0.5)
        drive(driver, state(0.0), (0.0, 0.0), error=error)
        drive(driver, state(PERIOD), (0.0, 0.0), wheel_speed=wheel_speed, error=error)
        return driver.odometry_w[0, 0, 0]

    real = navigation_error()
    assert odometry(1.1, real) == odometry(1.0, real)
    assert odometry(1.1, None) > odometry(1.0, None)
