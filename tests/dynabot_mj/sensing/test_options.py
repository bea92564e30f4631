import math

import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.estimation.parameters import DEFAULT
from dynabot_mj.sensing import options
from dynabot_mj.sensing.faults import Fault
from dynabot_mj.sensing.options import GpsErrors, SensorOptions, matched


def test_matched_sensors_have_the_errors_that_the_filters_assume():
    options = matched(DEFAULT)
    assert options.gps.position_noise == DEFAULT.position_noise
    assert options.imu.acceleration_drift == DEFAULT.acceleration_bias
    assert options.imu.acceleration_drift_time == DEFAULT.acceleration_bias_time
    assert options.magnetometer.noise == DEFAULT.bearing_noise
    assert options.ground.slope == options.imu.acceleration_scale == options.gps.stamp_error == 0.0


@pytest.mark.parametrize("stamp_error", [0.06, math.inf, -math.inf, math.nan])
def test_a_fix_cannot_arrive_before_its_stamp(stamp_error):
    options.check(SensorOptions(gps=GpsErrors(latency=0.05, stamp_error=0.05)), 1)
    options.check(SensorOptions(gps=GpsErrors(latency=0.05, stamp_error=-0.2)), 1)
    with pytest.raises(InputError, match=r"stamp_error = .* s given, it must not exceed gps\.latency, 0\.05 s"):
        options.check(SensorOptions(gps=GpsErrors(latency=0.05, stamp_error=stamp_error)), 1)


def test_faults_are_checked_with_the_sensors():
    with pytest.raises(InputError, match="robot 1 given, there are the robots 0 to 0"):
        options.check(SensorOptions(faults=(Fault(kind="outage", robots=(1,)),)), 1)
