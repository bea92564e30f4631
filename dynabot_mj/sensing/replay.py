"""Sensor samples on record, and estimators run over them: the same for simulated and for real robots."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.estimation.estimator import Estimator
from dynabot_mj.estimation.measurements import GpsFix, ImuSample
from dynabot_mj.sensing.ground_truth import GroundTruth
from dynabot_mj.sensing.options import SensorOptions
from dynabot_mj.sensing.sensors import Sensors


@dataclass(frozen=True, kw_only=True)
class Samples:
    """What the sensors of R runs said at N common times; NaN where a sample is missing."""

    time: Array  # (N,) [s]
    imu: ImuSample  # arrays (N, R, ...)
    fix: GpsFix  # arrays (N, R, ...)
    # True errors where they are known, (N, R, 5): gyro [rad/s], accelerometer ahead and to the left [m/s^2], GPS
    # position, slow part [m].
    errors: Array | None = None


@dataclass(frozen=True, kw_only=True)
class Track:
    """What an estimator believed at each sample."""

    time: Array  # (N,) [s]
    position_w: Array  # (N, R, 2) [m]
    velocity_w: Array  # (N, R, 2) [m/s]
    heading: Array  # (N, R) [rad]
    position_covariance: Array  # (N, R, 2, 2) [m^2]
    velocity_covariance_b: Array  # (N, R, 2, 2) [m^2/s^2]
    heading_variance: Array  # (N, R) [rad^2]
    known: BoolArray  # (N, R)
    fix_age: Array  # (N, R) [s]
    restarts: npt.NDArray[np.int64]  # (R,)


def record(truth: GroundTruth, options: SensorOptions, period: float, seed: int, first: int = 0) -> Samples:
    """Reads sensors along recorded drives.

    Args:
        truth: The drives, on a grid that divides the period.
        options: Errors of the sensors.
        period: Between two samples [s].
        seed: Of the errors.
        first: Number of the first run: the k-th one has the streams of trial first + k.
    """
    every = round(period / truth.interval)
    sensors = Sensors(options, period, seed, range(first, first + truth.runs), truth.state(0))
    due = np.ones((truth.runs, 1), dtype=bool)
    samples, errors, times = [], [], []
    for index in range(len(truth.time)):
        state = truth.state(index)
        sensors.substep(state)
        if index % every == 0:
            errors.append(sensors.slow_errors)
            samples.append(sensors.sample(state, due))
            times.append(state.time)

    def stacked(values: list[Array]) -> Array:
        return np.stack(values)[:, :, 0]

    return Samples(
        time=np.array(times),
        imu=ImuSample(
            period=stacked([imu.period for imu, _ in samples]),
            specific_force_b=stacked([imu.specific_force_b for imu, _ in samples]),
            yaw_rate=stacked([imu.yaw_rate for imu, _ in samples]),
            magnetic_heading=stacked([imu.magnetic_heading for imu, _ in samples]),
        ),
        fix=GpsFix(
            received=np.stack([fix.received for _, fix in samples])[:, :, 0],
            position_w=stacked([fix.position_w for _, fix in samples]),
            velocity_w=stacked([fix.velocity_w for _, fix in samples]),
            age=stacked([fix.age for _, fix in samples]),
        ),
        errors=stacked(errors),
    )


def follow(samples: Samples, estimator: Estimator, watch: Callable[[int], None] = lambda index: None) -> Track:
    """Runs an estimator over recorded samples.

    Args:
        samples: The record of R runs.
        estimator: A fresh one for (R,) robots.
        watch: Called after each sample with its index; for what only the estimator's filter can tell.
    """
    due = np.ones(samples.imu.magnetic_heading.shape[1], dtype=bool)
    beliefs = []
    for index in range(len(samples.time)):
        beliefs.append(estimator.step(samples.imu.at(index), samples.fix.at(index), due))
        watch(index)
    return Track(
        time=samples.time,
        position_w=np.stack([one.position_w for one in beliefs]),
        velocity_w=np.stack([one.velocity_w for one in beliefs]),
        heading=np.stack([one.heading for one in beliefs]),
        position_covariance=np.stack([one.position_covariance for one in beliefs]),
        velocity_covariance_b=np.stack([one.velocity_covariance_b for one in beliefs]),
        heading_variance=np.stack([one.heading_variance for one in beliefs]),
        known=np.stack([one.known for one in beliefs]),
        fix_age=np.stack([one.fix_age for one in beliefs]),
        restarts=beliefs[-1].restarts,
    )
