import numpy as np
import pytest

from dynabot_mj.estimation.coupled_ekf import CoupledEkf
from dynabot_mj.estimation.measurements import GpsFix, rotation
from dynabot_mj.estimation.motion import ACCELERATION_BIAS, HEADING, POSITION, POSITION_BIAS, VELOCITY
from dynabot_mj.estimation.parameters import DEFAULT, Parameters
from dynabot_mj.perception.estimators import build

ALL = slice(None)


@pytest.fixture
def started():
    found = CoupledEkf(2)
    fix = GpsFix(
        received=np.ones(2, dtype=bool),
        position_w=np.array([[1.0, 2.0], [5.0, 6.0]]),
        velocity_w=np.array([[3.0, -1.0], [0.5, 0.5]]),
        age=np.array([0.1, 0.2]),
    )
    found.begin(ALL, fix, np.array([0.5, -2.0]))
    return found


def test_a_first_fix_knows_the_sum_of_position_and_slow_error(started):
    """Position and slow error are each uncertain, and the fix saw their sum with its white noise alone."""
    p = started.covariance[1]
    total = p[0, 0] + 2.0 * p[0, 8] + p[8, 8]
    assert total == pytest.approx(DEFAULT.position_noise**2)
    assert p[8, 8] == pytest.approx(DEFAULT.position_bias**2)
    assert np.linalg.eigvalsh(p).min() > 0.0


def test_believing_a_bearing_keeps_the_velocity_over_ground_and_the_other_robot(started):
    before = started.beliefs()
    covariance = started.covariance.copy()
    started.believe_heading(np.array([1]), np.array([1.0]))
    after = started.beliefs()
    np.testing.assert_allclose(after["velocity_w"], before["velocity_w"], atol=1e-12)
    assert after["heading"][1] == 1.0
    np.testing.assert_allclose(started.state[1, VELOCITY], rotation(np.array(-1.0)) @ [0.5, 0.5])
    np.testing.assert_array_equal(started.covariance[0], covariance[0])
    assert started.covariance[1, HEADING, HEADING] == pytest.approx(DEFAULT.bearing_noise**2)


def test_believing_a_fix_keeps_the_biases_of_the_inertial_unit(started):
    started.state[:, ACCELERATION_BIAS], started.state[:, POSITION_BIAS] = 0.1, 0.4
    fix = GpsFix(
        received=np.ones(1, dtype=bool),
        position_w=np.array([[9.0, 9.0]]),
        velocity_w=np.array([[1.0, 0.0]]),
        age=np.array([0.5]),
    )
    started.believe_fix(np.array([0]), fix)
    np.testing.assert_allclose(started.state[0, POSITION], [9.5, 9.0])
    np.testing.assert_allclose(started.state[0, ACCELERATION_BIAS], 0.1)
    np.testing.assert_array_equal(started.state[0, POSITION_BIAS], 0.0)
    np.testing.assert_allclose(started.state[1, POSITION_BIAS], 0.4)


@pytest.mark.parametrize("name", ["decoupled", "coupled"])
def test_biases_of_the_accelerometer_are_learnt(name, straight):
    """A robot that keeps its velocity while its accelerometer claims another story."""
    lasting = Parameters(acceleration_bias_time=1e4)  # else the estimate is drawn towards zero
    estimator, bias_b = build(name, (1,), lasting), np.array([0.08, -0.05])
    for imu, fix in straight(600):
        imu.specific_force_b[:] = bias_b
        found = estimator.step(imu, fix, np.ones(1, dtype=bool))
    np.testing.assert_allclose(found.acceleration_bias_b[0], bias_b, rtol=0.1)
