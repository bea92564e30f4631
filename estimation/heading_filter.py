"""Heading and gyro bias: the two-state Kalman filter that GPS extrapolation and the decoupled EKF share.

phi' = phi + T (w - b_r),        b_r' = b_r,        z = phi (a magnetic heading, its innovation wrapped).
"""

import numpy as np

from dynabot_mj.estimation import kalman
from dynabot_mj.estimation.arrays import Array
from dynabot_mj.estimation.estimator import Rows
from dynabot_mj.estimation.kalman import Update
from dynabot_mj.estimation.measurements import ImuSample, wrap
from dynabot_mj.estimation.parameters import Parameters


class HeadingFilter:
    """x = [phi, b_r] of M robots."""

    def __init__(self, count: int, parameters: Parameters) -> None:
        """Starts anywhere; see `believe`.

        Args:
            count: M.
            parameters: Assumed errors.
        """
        self._parameters = parameters
        self.state = np.zeros((count, 2))
        self.covariance = np.tile(np.diag([parameters.bearing_noise**2, parameters.yaw_rate_bias**2]), (count, 1, 1))

    def begin(self, rows: Rows, magnetic_heading: Array) -> None:
        """Starts with a magnetic heading."""
        self.state[rows, 1] = 0.0
        self.believe(rows, magnetic_heading)
        self.covariance[rows, 1, 1] = self._parameters.yaw_rate_bias**2

    def believe(self, rows: Rows, magnetic_heading: Array) -> None:
        """Sets the heading to a magnetic heading."""
        self.state[rows, 0] = magnetic_heading
        self.covariance[rows, 0] = self.covariance[rows, :, 0] = 0.0
        self.covariance[rows, 0, 0] = self._parameters.bearing_noise**2

    def predict(self, rows: Rows, imu: ImuSample) -> Array:
        """Carries the state over a period and returns the mean yaw rate in it, (M,) [rad/s]."""
        state, covariance, time = self.state[rows], self.covariance[rows], imu.period
        yaw_rate = imu.yaw_rate - state[:, 1]
        cross, variance = covariance[:, 0, 1].copy(), covariance[:, 1, 1].copy()
        walk = self._parameters.yaw_rate_bias_walk**2 * time
        covariance[:, 0, 0] += time * (time * variance - 2.0 * cross) + self._parameters.yaw_rate_density**2 * time
        covariance[:, 0, 1] = covariance[:, 1, 0] = cross - time * variance
        covariance[:, 1, 1] += walk
        state[:, 0] += time * yaw_rate
        self.state[rows], self.covariance[rows] = state, covariance
        return yaw_rate

    def see_heading(self, rows: Rows, magnetic_heading: Array) -> Update:
        """Takes a magnetic heading; see `Filter.see_heading`."""
        state, parameters = self.state[rows], self._parameters
        update = kalman.update_one(
            state,
            self.covariance[rows],
            wrap(magnetic_heading - state[:, 0]),
            0,
            parameters.bearing_noise**2,
            kalman.threshold(parameters.gate, 1),
        )
        self.state[rows], self.covariance[rows] = update.state, update.covariance
        return update
