import numpy as np
import pytest

from dynabot_mj.estimation.filterpy_twins import GpsExtrapolation
from dynabot_mj.estimation.measurements import ImuSample
from dynabot_mj.estimation.parameters import DEFAULT


def test_a_fix_is_carried_on_with_its_own_velocity_whatever_the_accelerometer_says(fix):
    one = GpsExtrapolation()
    one.begin(fix, np.array(0.0))
    np.testing.assert_allclose(one.beliefs()["position_w"], [10.0, 20.3])
    for _ in range(4):
        one.predict(
            ImuSample(
                period=np.array(0.05),
                specific_force_b=np.array([9.0, 9.0]),
                yaw_rate=np.array(0.0),
                magnetic_heading=np.array(0.0),
            )
        )
    found = one.beliefs()
    np.testing.assert_allclose(found["position_w"], [10.0, 20.9])
    np.testing.assert_allclose(found["velocity_w"], [0.0, 3.0])
    # After 0.3 s in all an acceleration of 0.5 m/s^2 may have changed the velocity by 0.15 m/s.
    assert found["velocity_covariance_b"][0, 0] == pytest.approx(DEFAULT.velocity_noise**2 + 0.15**2)
