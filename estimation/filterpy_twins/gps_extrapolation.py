"""The twin of `dynabot_mj.estimation.gps_extrapolation`: only its heading is FilterPy's."""

from typing import Any

import numpy as np

from dynabot_mj.estimation.arrays import Array
from dynabot_mj.estimation.filterpy_twins.filters import sound
from dynabot_mj.estimation.filterpy_twins.heading_filter import HeadingFilter
from dynabot_mj.estimation.kalman import Update
from dynabot_mj.estimation.measurements import GpsFix, ImuSample
from dynabot_mj.estimation.parameters import DEFAULT, Parameters


class GpsExtrapolation:
    """Position and velocity of the last fix, carried on."""

    def __init__(self, parameters: Parameters = DEFAULT) -> None:
        """Starts anywhere; see `begin`."""
        self._parameters = parameters
        self._heading = HeadingFilter(parameters)
        self._motion = np.zeros(4)  # position and velocity over ground
        self._age = np.zeros(())

    @property
    def filters(self) -> tuple[Any, ...]:
        """FilterPy's filters."""
        return (self._heading.filter,)

    def sound(self) -> bool:
        """Tells whether all numbers are finite and all variances positive."""
        return sound(self._heading.filter) and bool(np.isfinite(self._motion).all())

    def begin(self, fix: GpsFix, magnetic_heading: Array) -> None:
        """Starts with a first fix and magnetic heading."""
        self._heading.begin(magnetic_heading)
        self.believe_fix(fix)

    def predict(self, imu: ImuSample) -> None:
        """Carries position and heading over a period."""
        self._heading.predict(imu)
        position_w, velocity_w = self._motion[:2], self._motion[2:]
        self._motion = np.concatenate([position_w + imu.period * velocity_w, velocity_w])
        self._age = self._age + imu.period

    def see_heading(self, magnetic_heading: Array) -> Update:
        """Takes a magnetic heading."""
        return self._heading.see_heading(magnetic_heading)

    def see_fix(self, fix: GpsFix, force_b: Array) -> tuple[Update, ...]:
        """Takes a fix as it is."""
        before, variance = self._motion, self._variance()
        self.believe_fix(fix)
        innovation = self._motion - before
        after = self._variance()
        return (
            Update(
                state=self._motion,
                covariance=np.diag(after),
                innovation=innovation,
                innovation_covariance=np.diag(variance + after),
                squared=(innovation**2 / (variance + after)).sum(),
                accepted=np.array(True),
            ),
        )

    def believe_heading(self, magnetic_heading: Array) -> None:
        """Sets the heading to a magnetic heading."""
        self._heading.believe(magnetic_heading)

    def believe_fix(self, fix: GpsFix) -> None:
        """Sets position and velocity to a fix."""
        self._motion = np.concatenate([fix.position_w + fix.age * fix.velocity_w, fix.velocity_w])
        self._age = fix.age

    def beliefs(self) -> dict[str, Array]:
        """Returns the fields of `Estimate`."""
        variance = self._variance()
        return {
            "position_w": self._motion[:2],
            "velocity_w": self._motion[2:],
            "heading": self._heading.filter.x[0],
            "yaw_rate_bias": self._heading.filter.x[1],
            "acceleration_bias_b": np.zeros(2),
            "position_covariance": np.diag(variance[:2]),
            "velocity_covariance_b": np.diag(variance[2:]),
            "heading_variance": self._heading.filter.P[0, 0],
        }

    def _variance(self) -> Array:
        """Returns the variances of position and velocity, (4,)."""
        p, age = self._parameters, self._age
        velocity = p.velocity_noise**2 + (p.acceleration_unknown * age) ** 2
        position = p.position_noise**2 + p.position_bias**2 + p.velocity_noise**2 * age**2
        position = position + (0.5 * p.acceleration_unknown * age**2) ** 2
        return np.array([position, position, velocity, velocity])
