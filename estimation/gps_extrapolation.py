"""GPS extrapolation (Sec. III.B): position and velocity are those of the last fix, carried on at constant velocity.

    at a fix of age L:   p = z_p + L z_v,   V = z_v            in between:   p' = p + T V

and a two-state filter has the heading. There is no gate: whatever the receiver says is believed.
"""

import numpy as np

from dynabot_mj.estimation.arrays import Array, BoolArray
from dynabot_mj.estimation.estimator import Rows
from dynabot_mj.estimation.heading_filter import HeadingFilter
from dynabot_mj.estimation.kalman import Update
from dynabot_mj.estimation.measurements import GpsFix, ImuSample
from dynabot_mj.estimation.parameters import DEFAULT, Parameters


class GpsExtrapolation:
    """The estimator "interpolated GPS" of Tables II and III, for M robots."""

    def __init__(self, count: int, parameters: Parameters = DEFAULT) -> None:
        """Starts anywhere; see `begin`.

        Args:
            count: M.
            parameters: Assumed errors.
        """
        self._parameters = parameters
        self._heading = HeadingFilter(count, parameters)
        self._position_w, self._velocity_w = np.zeros((count, 2)), np.zeros((count, 2))
        self._age = np.zeros(count)  # of the fix

    def begin(self, rows: Rows, fix: GpsFix, magnetic_heading: Array) -> None:
        """Starts with a first fix and magnetic heading."""
        self._heading.begin(rows, magnetic_heading)
        self.believe_fix(rows, fix)

    def predict(self, rows: Rows, imu: ImuSample) -> None:
        """Carries position and heading over a period."""
        self._heading.predict(rows, imu)
        self._position_w[rows] += imu.period[:, None] * self._velocity_w[rows]
        self._age[rows] += imu.period

    def see_heading(self, rows: Rows, magnetic_heading: Array) -> Update:
        """Takes a magnetic heading."""
        return self._heading.see_heading(rows, magnetic_heading)

    def see_fix(self, rows: Rows, fix: GpsFix, force_b: Array) -> tuple[Update]:
        """Takes a fix as it is; the update tells what it did, and accepts it always."""
        before = np.concatenate([self._position_w[rows], self._velocity_w[rows]], axis=-1)
        variance = self._variance(rows)
        self.believe_fix(rows, fix)
        after = np.concatenate([self._position_w[rows], self._velocity_w[rows]], axis=-1)
        covariance = self._variance(rows)[..., None] * np.eye(4)
        innovation_covariance = covariance + variance[..., None] * np.eye(4)
        innovation = after - before
        return (
            Update(
                state=after,
                covariance=covariance,
                innovation=innovation,
                innovation_covariance=innovation_covariance,
                squared=(innovation**2 / np.diagonal(innovation_covariance, axis1=1, axis2=2)).sum(axis=-1),
                accepted=np.ones(len(after), dtype=bool),
            ),
        )

    def believe_heading(self, rows: Rows, magnetic_heading: Array) -> None:
        """Sets the heading to a magnetic heading."""
        self._heading.believe(rows, magnetic_heading)

    def believe_fix(self, rows: Rows, fix: GpsFix) -> None:
        """Sets position and velocity to a fix."""
        self._position_w[rows] = fix.position_w + fix.age[:, None] * fix.velocity_w
        self._velocity_w[rows] = fix.velocity_w
        self._age[rows] = fix.age

    def sound(self) -> BoolArray:
        """Tells where all numbers are finite and all variances positive."""
        finite = np.isfinite(self._heading.state.sum(axis=-1) + self._position_w.sum(axis=-1))
        variances = np.diagonal(self._heading.covariance, axis1=1, axis2=2)
        return finite & (variances > 0.0).all(axis=-1) & (variances < 1e8).all(axis=-1)

    def beliefs(self) -> dict[str, Array]:
        """Returns the fields of `Estimate`."""
        variance = self._variance(slice(None))
        return {
            "position_w": self._position_w.copy(),
            "velocity_w": self._velocity_w.copy(),
            "heading": self._heading.state[:, 0].copy(),
            "yaw_rate_bias": self._heading.state[:, 1].copy(),
            "acceleration_bias_b": np.zeros_like(self._position_w),
            "position_covariance": variance[:, :2, None] * np.eye(2),
            "velocity_covariance_b": variance[:, 2:, None] * np.eye(2),
            "heading_variance": self._heading.covariance[:, 0, 0].copy(),
        }

    def _variance(self, rows: Rows) -> Array:
        """Returns the variances of position and velocity, which grow with the fix's age, (M, 4)."""
        p, age = self._parameters, self._age[rows]
        velocity = p.velocity_noise**2 + (p.acceleration_unknown * age) ** 2
        position = p.position_noise**2 + p.position_bias**2 + p.velocity_noise**2 * age**2
        position = position + (0.5 * p.acceleration_unknown * age**2) ** 2
        return np.stack([position, position, velocity, velocity], axis=-1)
