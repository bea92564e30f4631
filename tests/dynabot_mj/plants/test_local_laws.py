import numpy as np
import pytest

from controllers import gains
from dynabot_mj import scene
from dynabot_mj.plants import FleetState
from dynabot_mj.plants.local_laws import Drivers, LocalLaws, along

TUNED = gains.load("tuned")
PERIOD = 0.03


def state(time, velocity=(0.0, 0.0), heading=0.0):
    return FleetState(
        time=time,
        position_w=np.zeros((1, 1, 2)),
        velocity_w=np.array([[velocity]]),
        heading=np.full((1, 1), heading),
        yaw_rate=np.zeros((1, 1)),
        specific_impulse_b=np.zeros((1, 1, 2)),
    )


def drivers(**options):
    laws = LocalLaws(steering=TUNED.hand_point, traction=TUNED.traction, **options)
    return Drivers(laws, scene.read_robot().vehicle, state(0.0))


def drive(driver, state, force, wheel_speed=0.0):
    speed, torque = driver.drive(np.array([[force]]), state, np.zeros((1, 1)), np.full((1, 1, 4), wheel_speed), PERIOD)
    return speed[0, 0], torque[0, 0]


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


def test_along_is_the_forward_speed():
    assert along(np.array([3.0, 4.0]), np.array(np.pi / 2.0)) == pytest.approx(4.0)
