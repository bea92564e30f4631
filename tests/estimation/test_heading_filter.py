import numpy as np
import pytest

from dynabot_mj.estimation.heading_filter import HeadingFilter
from dynabot_mj.estimation.measurements import ImuSample, wrap
from dynabot_mj.estimation.parameters import DEFAULT

ALL = slice(None)


def sample(period, yaw_rate):
    return ImuSample(
        period=np.array([period]),
        specific_force_b=np.zeros((1, 2)),
        yaw_rate=np.array([yaw_rate]),
        magnetic_heading=np.array([np.nan]),
    )


@pytest.mark.parametrize("turning", [-1.0, 1.0])
def test_heading_goes_round_and_round(turning):
    """A bearing of -179 degrees beside a heading of 179 is two degrees away, not 358."""
    found, start, period = HeadingFilter(1, DEFAULT), turning * 3.1, 0.05
    found.begin(ALL, np.array([start]))
    for index in range(1, 400):
        found.predict(ALL, sample(period, turning))
        update = found.see_heading(ALL, np.array([wrap(start + turning * index * period)]))
        assert update.accepted[0]
    assert found.state[0, 0] == pytest.approx(start + turning * 399 * period, abs=1e-9)


def test_bias_of_the_gyro_is_learnt():
    found, bias = HeadingFilter(1, DEFAULT), 0.012
    found.begin(ALL, np.zeros(1))
    for _ in range(8000):
        found.predict(ALL, sample(0.05, bias))
        found.see_heading(ALL, np.zeros(1))
    assert found.state[0, 1] == pytest.approx(bias, rel=0.02)
    assert found.state[0, 0] == pytest.approx(0.0, abs=1e-3)


def test_prediction_is_the_dense_one():
    found = HeadingFilter(1, DEFAULT)
    found.begin(ALL, np.array([0.4]))
    found.state[0, 1] = 0.01
    found.covariance[0] = before = np.array([[0.02, 0.003], [0.003, 0.004]])
    yaw_rate = found.predict(ALL, sample(0.2, 0.5))
    jacobian = np.array([[1.0, -0.2], [0.0, 1.0]])
    noise = 0.2 * np.diag([DEFAULT.yaw_rate_density, DEFAULT.yaw_rate_bias_walk]) ** 2
    np.testing.assert_allclose(found.covariance[0], jacobian @ before @ jacobian.T + noise, rtol=1e-12)
    np.testing.assert_allclose(found.state[0], [0.4 + 0.2 * 0.49, 0.01], rtol=1e-12)
    assert yaw_rate[0] == pytest.approx(0.49)


def test_believing_a_bearing_forgets_the_heading_only():
    found = HeadingFilter(2, DEFAULT)
    found.state[:] = [[1.0, 0.01], [2.0, 0.02]]
    found.covariance[:] = [[0.02, 0.003], [0.003, 0.004]]
    found.believe(np.array([1]), np.array([-1.0]))
    np.testing.assert_array_equal(found.state, [[1.0, 0.01], [-1.0, 0.02]])
    np.testing.assert_array_equal(found.covariance[0], [[0.02, 0.003], [0.003, 0.004]])
    np.testing.assert_array_equal(found.covariance[1], [[DEFAULT.bearing_noise**2, 0.0], [0.0, 0.004]])
