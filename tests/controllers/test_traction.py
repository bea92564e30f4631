import numpy as np
import pytest

from controllers.steering import Motion
from controllers.traction import Traction, drive
from controllers.vehicle import Vehicle

VEHICLE = Vehicle(
    mass=12.0,
    wheel_inertia=0.007,
    wheel_radius=0.1,
    track=0.42,
    wheelbase=0.34,
    length=0.5,
    breadth=0.49,
    friction=0.75,
    torque_limit=2.0,
)
GAINS = Traction()


def command(speed=0.0, acceleration=0.0, yaw_rate=0.0, measured_speed=None, measured_yaw_rate=None):
    motion = Motion(speed=np.array(speed), acceleration=np.array(acceleration), yaw_rate=np.array(yaw_rate))
    measured = (
        np.array(speed if measured_speed is None else measured_speed),
        np.array(yaw_rate if measured_yaw_rate is None else measured_yaw_rate),
    )
    return drive(motion, *measured, vehicle=VEHICLE, gains=GAINS)


def test_effective_mass_and_turning_track_by_hand():
    # 12 kg + 4 x 0.007 kg m^2 / (0.1 m)^2, and 0.42 m + 0.34^2 / 0.42 m.
    assert VEHICLE.effective_mass == pytest.approx(14.8)
    assert VEHICLE.turning_track == pytest.approx(0.69524, abs=1e-5)


def test_without_error_the_wheels_roll_at_the_ground_speed():
    wheel_speed, torque = command(speed=3.0)
    np.testing.assert_allclose(wheel_speed, 30.0)
    np.testing.assert_allclose(torque, 0.0)


def test_turning_follows_the_kinematics_of_sliding_wheels():
    wheel_speed, torque = command(yaw_rate=2.0)
    rim = 2.0 * VEHICLE.turning_track / 2.0 / 0.1
    np.testing.assert_allclose(wheel_speed, [-rim, rim, -rim, rim])
    np.testing.assert_allclose(torque, GAINS.scrub_torque * np.array([-1, 1, -1, 1]), rtol=1e-4)


def test_acceleration_is_fed_forward():
    _, torque = command(acceleration=2.0)
    np.testing.assert_allclose(torque, 14.8 * 2.0 * 0.1 / 4.0)


@pytest.mark.parametrize("speed", [0.0, 4.0, -4.0])
def test_the_slip_of_the_commanded_wheel_speed_is_limited(speed):
    wheel_speed, _ = command(speed=speed + 50.0, measured_speed=speed)
    slip = wheel_speed * 0.1 - speed
    np.testing.assert_allclose(slip, GAINS.slip_limit + GAINS.slip_share * abs(speed))


def test_torque_never_exceeds_the_motors_limit():
    _, torque = command(acceleration=50.0, yaw_rate=3.0)
    assert np.abs(torque).max() == VEHICLE.torque_limit


def test_a_motion_of_zeros_brakes():
    wheel_speed, torque = command(measured_speed=0.5)
    assert (wheel_speed < 5.0).all()
    np.testing.assert_array_equal(torque, 0.0)
