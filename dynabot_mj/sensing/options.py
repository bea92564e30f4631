"""Errors of the sensors: how large, with the reason for each default; as the configuration has them.

They are of a small robot of the paper's time, and one set under which the three estimators have Table II's accuracy
on the circle; the paper gives none but the receiver's rate.
"""

import math
from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.common.validation import STRICT, NotNegative, Positive, Share
from dynabot_mj.estimation.parameters import Parameters
from dynabot_mj.sensing import faults as sensor_faults
from dynabot_mj.sensing.faults import Fault
from dynabot_mj.testbed.paper import TASK_TIMES


@dataclass(frozen=True, kw_only=True, config=STRICT)
class GpsErrors:
    """The receiver. The paper gives its rate only; the errors are of a single-frequency receiver of its time."""

    # T_g, between two fixes [s]
    period: Annotated[float, Field(ge=0.01, le=60.0)] = TASK_TIMES.gps_period
    latency: Annotated[float, Field(ge=0.0, le=0.5)] = (
        0.15  # from the instant that a fix is true at to its arrival [s]; to compute and send it
    )
    stamp_error: float = 0.03  # by how much the fix is older than its stamp says [s]; an uncalibrated serial line
    position_noise: NotNegative = 1.0  # white, per axis [m]
    position_bias: NotNegative = 0.75  # Gauss-Markov, per axis [m]; ionosphere, orbits
    position_bias_time: Positive = 60.0  # its correlation time [s]
    common: Share = 0.0  # share of that error's variance that all robots have in common; 0.8 is realistic
    velocity_noise: NotNegative = 0.11  # white, per axis [m/s]; Doppler
    velocity_bias: NotNegative = 0.015  # Gauss-Markov, per axis [m/s]
    velocity_bias_time: Positive = 10.0  # its correlation time [s]


@dataclass(frozen=True, kw_only=True, config=STRICT)
class ImuErrors:
    """The inertial unit: a small MEMS one, averaged over the sampling period. Densities are of white noise."""

    acceleration_density: NotNegative = 0.038  # [m/s^2/sqrt(Hz)]: 0.2 m/s^2 over 36 ms; the motors shake it
    acceleration_bias: NotNegative = 0.1  # from switching on, per axis [m/s^2]; 10 mg
    acceleration_drift: NotNegative = 0.02  # Gauss-Markov, per axis [m/s^2]; temperature
    acceleration_drift_time: Positive = 100.0  # its correlation time [s]
    acceleration_scale: NotNegative = 0.03  # deviation of the factor, per axis; a unit out of the box
    yaw_rate_density: NotNegative = math.radians(0.095)  # [rad/s/sqrt(Hz)]: 0.5 deg/s over 36 ms
    yaw_rate_bias: NotNegative = math.radians(0.5)  # from switching on, after a calibration at rest [rad/s]
    yaw_rate_drift: NotNegative = math.radians(0.05)  # Gauss-Markov [rad/s]; temperature
    yaw_rate_drift_time: Positive = 100.0  # its correlation time [s]
    yaw_rate_scale: NotNegative = 0.005  # deviation of the factor


@dataclass(frozen=True, kw_only=True, config=STRICT)
class MagnetometerErrors:
    """The magnetic heading, calibrated once."""

    noise: NotNegative = math.radians(2.0)  # white [rad]
    hard_iron: NotNegative = math.radians(6.0)  # largest error of the kind that comes once per turn [rad]
    soft_iron: NotNegative = math.radians(2.0)  # the same, twice per turn [rad]
    motors: NotNegative = math.radians(2.0)  # Gauss-Markov, by the motors' currents [rad]
    motors_time: Positive = 1.0  # its correlation time [s]


@dataclass(frozen=True, kw_only=True, config=STRICT)
class GroundErrors:
    """How the ground tilts a robot."""

    unevenness: NotNegative = math.radians(0.7)  # deviation of pitch and roll [rad]; a car park without suspension
    unevenness_time: Positive = 0.3  # its correlation time [s]; about a metre of way
    slope: NotNegative = math.radians(0.45)  # of the whole ground, in a direction of chance [rad]; drainage


@dataclass(frozen=True, kw_only=True, config=STRICT)
class WheelErrors:
    """Resolution of the converters."""

    speed: NotNegative = 0.1  # [rad/s]; 1 cm/s at the rim
    current: NotNegative = 0.05  # [A]


@dataclass(frozen=True, kw_only=True, config=STRICT)
class SensorOptions:
    """All sensors of a robot."""

    gps: GpsErrors = GpsErrors()
    imu: ImuErrors = ImuErrors()
    magnetometer: MagnetometerErrors = MagnetometerErrors()
    ground: GroundErrors = GroundErrors()
    wheels: WheelErrors = WheelErrors()
    faults: tuple[Fault, ...] = ()


def check(options: SensorOptions, robots: int) -> None:
    """Checks what no single value shows.

    Args:
        options: All sensors of a robot.
        robots: Number of robots n.

    Raises:
        InputError: With the values that do not fit together.
    """
    gps = options.gps
    # Else a fix arrives before the time that is stamped on it.
    if not (math.isfinite(gps.stamp_error) and gps.stamp_error <= gps.latency):
        raise InputError(
            f"sensors.gps.stamp_error = {gps.stamp_error:g} s given, it must not exceed gps.latency, {gps.latency:g} s"
        )
    sensor_faults.check(options.faults, robots)


def matched(parameters: Parameters) -> SensorOptions:
    """Returns sensors with just the errors that filters of these parameters assume, but for what walks at random."""
    return SensorOptions(
        gps=GpsErrors(
            stamp_error=0.0,
            position_noise=parameters.position_noise,
            position_bias=parameters.position_bias,
            position_bias_time=parameters.position_bias_time,
            velocity_noise=parameters.velocity_noise,
            velocity_bias=0.0,
        ),
        imu=ImuErrors(
            acceleration_density=parameters.acceleration_density,
            acceleration_bias=0.0,
            acceleration_drift=parameters.acceleration_bias,
            acceleration_drift_time=parameters.acceleration_bias_time,
            acceleration_scale=0.0,
            yaw_rate_density=parameters.yaw_rate_density,
            yaw_rate_bias=parameters.yaw_rate_bias,
            yaw_rate_drift=0.0,
            yaw_rate_scale=0.0,
        ),
        magnetometer=MagnetometerErrors(noise=parameters.bearing_noise, hard_iron=0.0, soft_iron=0.0, motors=0.0),
        ground=GroundErrors(unevenness=0.0, slope=0.0),
    )
