"""Logs of one robot's sensors: in memory, from a recorded run, and from and to files; `docs/logs.md` is about them.

Fixes stand in the row of the sample that they had arrived before, with the time stamped on them.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dynabot_mj.common.arrays import Array, measured
from dynabot_mj.estimation.measurements import GpsFix, ImuSample
from dynabot_mj.sensing.ground_truth import GroundTruth
from dynabot_mj.sensing.logs import files
from dynabot_mj.sensing.logs.columns import QUANTITIES
from dynabot_mj.sensing.options import WheelErrors
from dynabot_mj.sensing.replay import Samples


@dataclass(frozen=True, kw_only=True)
class Log:
    """What the sensors of one robot said in N rows; NaN where a sample is missing."""

    time: Array  # (N,) increasing [s]
    specific_force_b: Array  # (N, 2) mean since the row before, ahead and to the left [m/s^2]
    yaw_rate: Array  # (N,) mean since the row before, counter-clockwise [rad/s]
    bearing: Array  # (N,) from the world's x axis, counter-clockwise [rad]
    fix_time: Array  # (N,) stamped on the fix that has arrived since the row before; NaN: none has [s]
    fix_position_w: Array  # (N, 2) [m]
    fix_velocity_w: Array  # (N, 2) [m/s]
    wheel_speed: Array | None = None  # (N, 4), order of `scene.WHEELS` [rad/s]
    motor_current: Array | None = None  # (N, 4), the same order [A]
    position_w: Array | None = None  # (N, 2) true [m]
    heading: Array | None = None  # (N,) true [rad]

    @property
    def samples(self) -> Samples:
        """The same as samples of a single run."""
        return Samples(
            time=self.time,
            imu=ImuSample(
                period=np.diff(self.time, prepend=self.time[:1])[:, None],
                specific_force_b=self.specific_force_b[:, None],
                yaw_rate=self.yaw_rate[:, None],
                magnetic_heading=self.bearing[:, None],
            ),
            fix=GpsFix(
                received=np.isfinite(self.fix_time)[:, None],
                position_w=self.fix_position_w[:, None],
                velocity_w=self.fix_velocity_w[:, None],
                age=(self.time - self.fix_time)[:, None],
            ),
        )


def from_run(samples: Samples, truth: GroundTruth, run: int, wheels: WheelErrors) -> Log:
    """Returns the log of one recorded run, with the truth and, where there are wheels, what their converters read.

    Args:
        samples: Of `replay.record`.
        truth: The drives that they are of.
        run: Its index.
        wheels: Resolution of the converters.
    """
    fix = samples.fix
    # To estimators a fix that is not finite is none.
    values = np.concatenate([fix.position_w[:, run], fix.velocity_w[:, run], fix.age[:, run, None]], axis=-1)
    received = fix.received[:, run] & np.isfinite(values).all(axis=-1)
    grid = np.rint((samples.time - truth.time[0]) / truth.interval).astype(np.intp)

    def read(values: Array | None, resolution: float) -> Array | None:
        return None if values is None else measured(values[grid, run], resolution)

    return Log(
        time=samples.time,
        specific_force_b=_finite(samples.imu.specific_force_b[:, run]),
        yaw_rate=_finite(samples.imu.yaw_rate[:, run]),
        bearing=_finite(samples.imu.magnetic_heading[:, run]),
        fix_time=np.where(received, samples.time - fix.age[:, run], np.nan),
        fix_position_w=np.where(received[:, None], fix.position_w[:, run], np.nan),
        fix_velocity_w=np.where(received[:, None], fix.velocity_w[:, run], np.nan),
        wheel_speed=read(truth.wheel_speed, wheels.speed),
        motor_current=read(truth.motor_current, wheels.current),
        position_w=truth.position_w[grid, run],
        heading=truth.heading[grid, run],
    )


def write(path: Path, log: Log) -> None:
    """Writes a log; equal logs give equal bytes.

    Args:
        path: Its name says the format, .csv or .nc.
        log: What to write.

    Raises:
        InputError: If the name has another extension, or if `read` would refuse the log.
    """
    columns: dict[str, Array] = {}
    for field, quantity in QUANTITIES.items():
        values: Array | None = getattr(log, field)
        if values is not None:
            columns |= zip(quantity.columns, values.reshape(len(log.time), -1).T, strict=True)
    files.write(path, columns)


def read(path: Path) -> Log:
    """Reads a log.

    Args:
        path: CSV or NetCDF, by its extension.

    Raises:
        InputError: If it cannot be read, or estimators could not be run over it; see `log_files.read`.
    """
    columns = files.read(path)
    fields = {}
    for field, quantity in QUANTITIES.items():
        if quantity.columns[0] in columns:
            values = [columns[name] for name in quantity.columns]
            fields[field] = values[0] if len(values) == 1 else np.stack(values, axis=-1)
    return Log(**fields)


def _finite(values: Array) -> Array:
    """Returns samples with those missing that are not finite: to estimators they are the same."""
    return np.where(np.isfinite(values), values, np.nan)
