"""What estimators are given, and what they return.

A sample that is missing is NaN; estimators treat every non-finite sample as missing. Leading axes are the caller's,
e.g. `(trials, robots)`, and the same for all arrays.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dynabot_mj.estimation.arrays import Array, BoolArray

Chosen = int | npt.NDArray[np.intp] | BoolArray


@dataclass(frozen=True, kw_only=True)
class ImuSample:
    """An inertial unit's averages over the period that ends now, and its magnetic heading now.

    Attributes:
        period: (...) that the averages are over; 0: none has passed yet [s].
        specific_force_b: (..., 2) ahead and to the left [m/s^2].
        yaw_rate: (...) [rad/s].
        magnetic_heading: (...) magnetic, from the world's x axis [rad].

    Example:
        >>> imu = dy.ImuSample(
        ...     period=np.full(3, 0.036),
        ...     specific_force_b=np.zeros((3, 2)),
        ...     yaw_rate=np.zeros(3),
        ...     magnetic_heading=np.array([0.0, np.nan, 1.0]),  # the second robot's is missing
        ... )
        >>> imu.at(2).magnetic_heading.item()
        1.0
    """

    period: Array
    specific_force_b: Array
    yaw_rate: Array
    magnetic_heading: Array

    def at(self, chosen: Chosen) -> "ImuSample":
        """Returns one of the first leading axis, or several of them."""
        return ImuSample(
            period=self.period[chosen],
            specific_force_b=self.specific_force_b[chosen],
            yaw_rate=self.yaw_rate[chosen],
            magnetic_heading=self.magnetic_heading[chosen],
        )


@dataclass(frozen=True, kw_only=True)
class GpsFix:
    """The fix that has arrived since the last sample, where one has.

    Attributes:
        received: (...) whether one has; elsewhere the rest means nothing.
        position_w: (..., 2) [m].
        velocity_w: (..., 2) [m/s].
        age: (...) since the time stamped on it [s].

    Example:
        >>> fix = dy.GpsFix(
        ...     received=np.array([True, False]),
        ...     position_w=np.array([[5.0, 0.0], [np.nan, np.nan]]),
        ...     velocity_w=np.zeros((2, 2)),
        ...     age=np.array([0.1, np.nan]),
        ... )
        >>> fix.at(fix.received).position_w
        array([[5., 0.]])
    """

    received: BoolArray
    position_w: Array
    velocity_w: Array
    age: Array

    def at(self, chosen: Chosen) -> "GpsFix":
        """Returns one of the first leading axis, or several of them."""
        return GpsFix(
            received=self.received[chosen],
            position_w=self.position_w[chosen],
            velocity_w=self.velocity_w[chosen],
            age=self.age[chosen],
        )


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """What an estimator believes now."""

    position_w: Array  # (..., 2) [m]
    velocity_w: Array  # (..., 2) [m/s]
    heading: Array  # (...) [rad]
    yaw_rate_bias: Array  # (...) of the gyro [rad/s]
    acceleration_bias_b: Array  # (..., 2) of the accelerometer; zero where not estimated [m/s^2]
    position_covariance: Array  # (..., 2, 2) [m^2]
    velocity_covariance_b: Array  # (..., 2, 2) ahead and to the left [m^2/s^2]
    heading_variance: Array  # (...) [rad^2]
    known: BoolArray  # (...) whether there has been a fix; before that the rest means nothing
    fix_age: Array  # (...) since the last fix that was believed; inf before the first [s]
    restarts: npt.NDArray[np.int64]  # (...) times that the estimator had diverged and was started again

    @property
    def stale(self) -> BoolArray:
        """Whether the position has been carried on without a fix for too long to be trusted, (...)."""
        return self.fix_age > STALE


STALE = 0.5  # age of the last believed fix from which an estimate is stale [s]


def rotation(angle: Array) -> Array:
    """Returns R(angle), which turns vectors to the left, (..., 2, 2)."""
    cos, sin = np.cos(angle), np.sin(angle)
    matrix = np.empty((*cos.shape, 2, 2))  # filled in place: stacking takes several times as long
    matrix[..., 0, 0] = matrix[..., 1, 1] = cos
    matrix[..., 0, 1], matrix[..., 1, 0] = -sin, sin
    return matrix


def wrap(angle: Array) -> Array:
    """Returns an angle in [-pi, pi) [rad]."""
    return (angle + np.pi) % (2.0 * np.pi) - np.pi
