import numpy as np
import pytest

from dynabot_mj.estimation.gps_extrapolation import GpsExtrapolation
from dynabot_mj.estimation.measurements import GpsFix, ImuSample
from dynabot_mj.estimation.parameters import DEFAULT

ALL = slice(None)


def fix(position_w=(1.0, 2.0), velocity_w=(3.0, -1.0), age=0.15):
    return GpsFix(
        received=np.ones(1, dtype=bool),
        position_w=np.array([position_w]),
        velocity_w=np.array([velocity_w]),
        age=np.array([age]),
    )


def sample(period):
    return ImuSample(
        period=np.array([period]),
        specific_force_b=np.full((1, 2), 9.0),
        yaw_rate=np.zeros(1),
        magnetic_heading=np.zeros(1),
    )


@pytest.fixture
def started():
    found = GpsExtrapolation(1)
    found.begin(ALL, fix(), np.array([0.5]))
    return found


def test_a_fix_is_carried_on_by_its_age(started):
    beliefs = started.beliefs()
    np.testing.assert_allclose(beliefs["position_w"], [[1.45, 1.85]])
    np.testing.assert_allclose(beliefs["velocity_w"], [[3.0, -1.0]])


def test_velocity_is_constant_between_fixes_whatever_the_accelerometer_says(started):
    started.predict(ALL, sample(0.1))
    started.predict(ALL, sample(0.3))
    beliefs = started.beliefs()
    np.testing.assert_allclose(beliefs["position_w"], [[1.45 + 1.2, 1.85 - 0.4]])
    np.testing.assert_allclose(beliefs["velocity_w"], [[3.0, -1.0]])


def test_variances_are_those_of_an_unknown_acceleration(started):
    started.predict(ALL, sample(0.85))  # the fix is a second old
    p, beliefs = DEFAULT, started.beliefs()
    velocity = p.velocity_noise**2 + p.acceleration_unknown**2
    position = p.position_noise**2 + p.position_bias**2 + p.velocity_noise**2 + 0.25 * p.acceleration_unknown**2
    np.testing.assert_allclose(beliefs["velocity_covariance_b"][0], velocity * np.eye(2))
    np.testing.assert_allclose(beliefs["position_covariance"][0], position * np.eye(2))


def test_every_fix_is_believed_and_its_innovation_told(started):
    (update,) = started.see_fix(ALL, fix(position_w=(101.0, 2.0), age=0.15), np.zeros((1, 2)))
    assert update.accepted.all()
    np.testing.assert_allclose(update.innovation, [[100.0, 0.0, 0.0, 0.0]], atol=1e-12)
    assert update.squared[0] == pytest.approx(1e4 / update.innovation_covariance[0, 0, 0])
    np.testing.assert_allclose(started.beliefs()["position_w"], [[101.45, 1.85]])


def test_a_broken_heading_is_not_sound(started):
    assert started.sound().all()
    started._heading.covariance[0, 1, 1] = np.nan
    assert not started.sound().any()
