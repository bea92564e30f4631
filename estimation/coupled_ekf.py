"""The coupled EKF (Sec. III.B): all ten states in one filter, by the models of `dynabot_mj.estimation.motion`.

The GPS position's slow error cannot be told from the position by fixes alone; it is observable through its assumed
correlation time. So a first fix starts both with their full, opposite correlation.
"""

import numpy as np

from dynabot_mj.estimation import kalman, motion
from dynabot_mj.estimation.arrays import Array, BoolArray
from dynabot_mj.estimation.estimator import Rows
from dynabot_mj.estimation.kalman import Update
from dynabot_mj.estimation.measurements import GpsFix, ImuSample, rotation, wrap
from dynabot_mj.estimation.motion import (
    ACCELERATION_BIAS,
    HEADING,
    POSITION,
    POSITION_BIAS,
    STATES,
    VELOCITY,
    YAW_RATE_BIAS,
)
from dynabot_mj.estimation.parameters import DEFAULT, Parameters


class CoupledEkf:
    """x, P of M robots."""

    def __init__(self, count: int, parameters: Parameters = DEFAULT) -> None:
        """Starts anywhere; see `begin`.

        Args:
            count: M.
            parameters: Assumed errors.
        """
        self._parameters = parameters
        self.state = np.zeros((count, STATES))
        self.covariance = np.tile(np.eye(STATES), (count, 1, 1))
        self._fix_noise = np.diag([parameters.position_noise**2] * 2 + [parameters.velocity_noise**2] * 2)

    def begin(self, rows: Rows, fix: GpsFix, magnetic_heading: Array) -> None:
        """Starts with a first fix and magnetic heading."""
        p = self._parameters
        self.state[rows] = 0.0
        self.covariance[rows] = 0.0
        self.covariance[rows, YAW_RATE_BIAS, YAW_RATE_BIAS] = p.yaw_rate_bias**2
        for index in range(STATES)[ACCELERATION_BIAS]:
            self.covariance[rows, index, index] = p.acceleration_bias**2
        self.believe_heading(rows, magnetic_heading)
        self.believe_fix(rows, fix)

    def predict(self, rows: Rows, imu: ImuSample) -> None:
        """Carries the state over a period."""
        prediction = motion.predict(self.state[rows], imu, self._parameters)
        self.state[rows] = prediction.state
        self.covariance[rows] = kalman.propagate(self.covariance[rows], prediction.jacobian, prediction.noise)

    def see_heading(self, rows: Rows, magnetic_heading: Array) -> Update:
        """Takes a magnetic heading."""
        state, p = self.state[rows], self._parameters
        innovation = wrap(magnetic_heading - state[:, HEADING])
        gate = kalman.threshold(p.gate, 1)
        return self._taken(
            rows, kalman.update_one(state, self.covariance[rows], innovation, HEADING, p.bearing_noise**2, gate)
        )

    def see_fix(self, rows: Rows, fix: GpsFix, force_b: Array) -> tuple[Update]:
        """Takes a fix: position and velocity at once."""
        state = self.state[rows]
        reading, observation = motion.fix_model(state, force_b, fix.age)
        innovation = np.concatenate([fix.position_w, fix.velocity_w], axis=-1) - reading
        gate = kalman.threshold(self._parameters.gate, 4)
        update = kalman.update(state, self.covariance[rows], innovation, observation, self._fix_noise, gate)
        return (self._taken(rows, update),)

    def believe_heading(self, rows: Rows, magnetic_heading: Array) -> None:
        """Sets the heading to a magnetic one; body axes turn under the velocity, which stays what it is over ground."""
        state = self.state[rows]
        turn = rotation(state[:, HEADING] - magnetic_heading)
        state[:, VELOCITY] = motion.turned(turn, state[:, VELOCITY])
        state[:, HEADING] = magnetic_heading
        self.state[rows] = state
        self._forget(rows, [HEADING], np.array([self._parameters.bearing_noise**2]))

    def believe_fix(self, rows: Rows, fix: GpsFix) -> None:
        """Sets position and velocity to a fix, and the position's slow error to zero."""
        p, state = self._parameters, self.state[rows]
        state[:, POSITION] = fix.position_w + fix.age[:, None] * fix.velocity_w
        state[:, VELOCITY] = motion.turned(rotation(-state[:, HEADING]), fix.velocity_w)
        state[:, POSITION_BIAS] = 0.0
        self.state[rows] = state
        bias, velocity = p.position_bias**2, p.velocity_noise**2
        variances = np.array([p.position_noise**2 + bias] * 2 + [velocity] * 2 + [bias] * 2)
        self._forget(rows, [0, 1, 2, 3, 8, 9], variances)
        for position, slow in ((0, 8), (1, 9)):
            self.covariance[rows, position, slow] = self.covariance[rows, slow, position] = -bias

    def sound(self) -> BoolArray:
        """Tells where all numbers are finite and all variances positive."""
        variances = np.diagonal(self.covariance, axis1=1, axis2=2)
        positive = (variances > 0.0).all(axis=-1) & (variances < 1e8).all(axis=-1)
        return np.isfinite(self.state.sum(axis=-1)) & positive

    def beliefs(self) -> dict[str, Array]:
        """Returns the fields of `Estimate`."""
        state, covariance = self.state, self.covariance
        return {
            "position_w": state[:, POSITION].copy(),
            "velocity_w": motion.turned(rotation(state[:, HEADING]), state[:, VELOCITY]),
            "heading": state[:, HEADING].copy(),
            "yaw_rate_bias": state[:, YAW_RATE_BIAS].copy(),
            "acceleration_bias_b": state[:, ACCELERATION_BIAS].copy(),
            "position_covariance": covariance[:, POSITION, POSITION].copy(),
            "velocity_covariance_b": covariance[:, VELOCITY, VELOCITY].copy(),
            "heading_variance": covariance[:, HEADING, HEADING].copy(),
        }

    def moments(self) -> tuple[Array, Array]:
        """Returns x, (M, 10), and P, (M, 10, 10)."""
        return self.state, self.covariance

    def _taken(self, rows: Rows, update: Update) -> Update:
        self.state[rows], self.covariance[rows] = update.state, update.covariance
        return update

    def _forget(self, rows: Rows, indices: list[int], variances: Array) -> None:
        """Cuts what is known of some states off from the rest."""
        covariance = self.covariance[rows]
        covariance[:, indices, :] = 0.0
        covariance[:, :, indices] = 0.0
        covariance[:, indices, indices] = variances
        self.covariance[rows] = covariance
