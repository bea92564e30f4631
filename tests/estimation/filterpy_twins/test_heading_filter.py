import numpy as np
import pytest

from dynabot_mj.estimation.filterpy_twins.heading_filter import HeadingFilter
from dynabot_mj.estimation.measurements import ImuSample
from dynabot_mj.estimation.parameters import DEFAULT


@pytest.fixture
def started():
    """Heads almost west."""
    one = HeadingFilter(DEFAULT)
    one.begin(np.array(3.1))
    return one


def test_a_bearing_beyond_the_jump_is_near(started):
    # From 3.1 to -3.1 it is 2 pi - 6.2 to the left; belief and bearing are equally uncertain, so half of it is taken.
    update = started.see_heading(np.array(-3.1))
    assert update.accepted
    assert started.filter.x[0] == pytest.approx(3.1 + 0.5 * (2.0 * np.pi - 6.2))
    assert started.filter.P[0, 0] == pytest.approx(0.5 * DEFAULT.bearing_noise**2)


def test_it_turns_with_the_gyro_less_its_bias(started):
    started.filter.x = np.array([0.0, 0.02])
    imu = ImuSample(
        period=np.array(0.5), specific_force_b=np.zeros(2), yaw_rate=np.array(0.12), magnetic_heading=np.array(np.nan)
    )
    assert started.predict(imu) == pytest.approx(0.1)
    assert started.filter.x == pytest.approx([0.05, 0.02])
    # The gyro's noise, and half a second of a bias that is not known.
    grown = DEFAULT.yaw_rate_density**2 * 0.5 + (0.5 * DEFAULT.yaw_rate_bias) ** 2
    assert started.filter.P[0, 0] - DEFAULT.bearing_noise**2 == pytest.approx(grown)


def test_a_believed_bearing_leaves_the_bias(started):
    started.filter.x = np.array([0.0, 0.02])
    started.believe(np.array(1.0))
    assert started.filter.x == pytest.approx([1.0, 0.02])
    assert started.filter.P[0, 1] == 0.0
