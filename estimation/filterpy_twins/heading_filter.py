"""The twin of `dynabot_mj.estimation.heading_filter`: x = [phi, b_r].

FilterPy subtracts angles without wrapping, so a magnetic heading z is passed as phi + wrap(z - phi).
"""

import numpy as np

from dynabot_mj.estimation import kalman
from dynabot_mj.estimation.arrays import Array
from dynabot_mj.estimation.filterpy_twins.filters import judged, linear
from dynabot_mj.estimation.kalman import Update
from dynabot_mj.estimation.measurements import ImuSample, wrap
from dynabot_mj.estimation.parameters import Parameters


class HeadingFilter:
    """Heading and gyro bias."""

    def __init__(self, parameters: Parameters) -> None:
        """Starts at heading zero; see `begin`."""
        self._parameters = parameters
        self.filter = linear(1.0, 0.0)
        self.begin(np.zeros(()))

    def begin(self, magnetic_heading: Array) -> None:
        """Starts with a magnetic heading."""
        p = self._parameters
        self.filter.x = np.array([magnetic_heading, 0.0])
        self.filter.P = np.diag([p.bearing_noise**2, p.yaw_rate_bias**2])

    def believe(self, magnetic_heading: Array) -> None:
        """Sets the heading to a magnetic heading."""
        bias_variance = self.filter.P[1, 1]
        self.filter.x = np.array([magnetic_heading, self.filter.x[1]])
        self.filter.P = np.diag([self._parameters.bearing_noise**2, bias_variance])

    def predict(self, imu: ImuSample) -> Array:
        """Carries the state over a period and returns the mean yaw rate in it."""
        p, t = self._parameters, imu.period
        yaw_rate: Array = imu.yaw_rate - self.filter.x[1]
        self.filter.predict(
            u=imu.yaw_rate[None],
            B=np.array([[t], [0.0]]),
            F=np.array([[1.0, -t], [0.0, 1.0]]),
            Q=np.diag([p.yaw_rate_density**2 * t, p.yaw_rate_bias_walk**2 * t]),
        )
        return yaw_rate

    def see_heading(self, magnetic_heading: Array) -> Update:
        """Takes a magnetic heading."""
        p, heading = self._parameters, self.filter.x[0]
        innovation = wrap(magnetic_heading - heading)
        noise = np.array([[p.bearing_noise**2]])
        gate = kalman.threshold(p.gate, 1)
        return judged(self.filter, gate, innovation[None], heading + innovation, R=noise)
