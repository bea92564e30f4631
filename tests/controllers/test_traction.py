import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynabot_mj.controllers.steering import Motion
from dynabot_mj.controllers.traction import SIDES, Traction, drive

GAINS = Traction(
    speed_gain=0.5, yaw_gain=2.0, scrub_torque=1.45, scrub_rate=0.3, slip_limit=0.6, slip_share=0.15
)  # fmt: skip
MEASURED = st.floats(-6.0, 6.0)


@pytest.fixture(scope="module")
def command(vehicle):
    def commanded(speed=0.0, acceleration=0.0, yaw_rate=0.0, measured_speed=None, measured_yaw_rate=None):
        motion = Motion(speed=np.array(speed), acceleration=np.array(acceleration), yaw_rate=np.array(yaw_rate))
        measured = (
            np.array(speed if measured_speed is None else measured_speed),
            np.array(yaw_rate if measured_yaw_rate is None else measured_yaw_rate),
        )
        return drive(motion, *measured, vehicle=vehicle, gains=GAINS)

    return commanded


def no_load(wheel_speed, torque, vehicle):
    """Rim speed at which a motor's torque, K (commanded - actual) + feed-forward, vanishes [m/s]."""
    return vehicle.wheel_radius * (wheel_speed + torque / vehicle.servo_gain)


def test_effective_mass_and_turning_track_by_hand(vehicle):
    # 12 kg + 4 x 0.007 kg m^2 / (0.1 m)^2, and 0.42 m + 0.34^2 / 0.42 m.
    assert vehicle.effective_mass == pytest.approx(14.8)
    assert vehicle.turning_track == pytest.approx(0.69524, abs=1e-5)


def test_without_error_the_wheels_roll_at_the_ground_speed(command):
    wheel_speed, torque = command(speed=3.0)
    np.testing.assert_allclose(wheel_speed, 30.0)
    np.testing.assert_allclose(torque, 0.0)


def test_turning_follows_the_kinematics_of_sliding_wheels(command, vehicle):
    wheel_speed, torque = command(yaw_rate=2.0)
    rim = 2.0 * vehicle.turning_track / 2.0 / 0.1
    np.testing.assert_allclose(wheel_speed, [-rim, rim, -rim, rim])
    np.testing.assert_allclose(torque, GAINS.scrub_torque * SIDES, rtol=1e-4)


def test_errors_of_speed_and_yaw_rate_are_fed_back(command, vehicle):
    wheel_speed, torque = command(speed=3.0, measured_speed=2.8)
    np.testing.assert_allclose(wheel_speed, (3.0 + 0.5 * 0.2) / 0.1)
    np.testing.assert_array_equal(torque, 0.0)
    wheel_speed, _ = command(yaw_rate=0.0, measured_yaw_rate=-0.4)
    np.testing.assert_allclose(wheel_speed, 2.0 * 0.4 * vehicle.turning_track / 2.0 / 0.1 * SIDES)


def test_acceleration_is_fed_forward(command):
    _, torque = command(acceleration=2.0)
    np.testing.assert_allclose(torque, 14.8 * 2.0 * 0.1 / 4.0)


@pytest.mark.parametrize("speed", [0.0, 4.0, -4.0])
def test_the_slip_of_the_commanded_wheel_speed_is_limited(command, speed):
    wheel_speed, _ = command(speed=speed + 50.0, measured_speed=speed)
    np.testing.assert_allclose(wheel_speed * 0.1 - speed, GAINS.slip_limit + GAINS.slip_share * abs(speed))


def test_the_limit_counts_the_torque_in(command, vehicle):
    # 14.8 kg x 5 m/s^2 x 0.1 m / 4 = 1.85 Nm push a free wheel 3.7 rad/s beyond its command.
    wheel_speed, torque = command(speed=50.0, acceleration=5.0, measured_speed=0.0)
    np.testing.assert_allclose(wheel_speed, (GAINS.slip_limit - 0.37) / 0.1)
    np.testing.assert_allclose(no_load(wheel_speed, torque, vehicle), GAINS.slip_limit)


@given(speed=MEASURED, measured=MEASURED, yaw_rate=MEASURED, turning=MEASURED, acceleration=MEASURED)
def test_no_free_wheel_runs_off_by_more_than_the_slip_limit(
    command, vehicle, speed, measured, yaw_rate, turning, acceleration
):
    wheel_speed, torque = command(speed, acceleration, yaw_rate, measured, turning)
    ground = measured + SIDES * turning * vehicle.turning_track / 2.0
    slip = no_load(wheel_speed, torque, vehicle) - ground
    assert (np.abs(slip) <= GAINS.slip_limit + GAINS.slip_share * np.abs(ground) + 1e-9).all()
    assert (np.abs(torque) <= vehicle.torque_limit).all()


@given(speed=MEASURED, measured=MEASURED, yaw_rate=MEASURED, turning=MEASURED, acceleration=MEASURED)
def test_left_and_right_and_forward_and_back_are_alike(command, speed, measured, yaw_rate, turning, acceleration):
    one = command(speed, acceleration, yaw_rate, measured, turning)
    mirrored = command(speed, acceleration, -yaw_rate, measured, -turning)
    backward = command(-speed, -acceleration, -yaw_rate, -measured, -turning)
    for as_is, left, back in zip(one, mirrored, backward, strict=True):
        np.testing.assert_allclose(left, as_is[[1, 0, 3, 2]], atol=1e-9)
        np.testing.assert_allclose(back, -as_is, atol=1e-9)


def test_torque_never_exceeds_the_motors_limit(command, vehicle):
    _, torque = command(acceleration=50.0, yaw_rate=3.0)
    assert np.abs(torque).max() == vehicle.torque_limit


def test_a_motion_of_zeros_brakes(command):
    wheel_speed, torque = command(measured_speed=0.5)
    assert (wheel_speed < 5.0).all()
    np.testing.assert_array_equal(torque, 0.0)
