"""The twin of `dynabot_mj.estimation.coupled_ekf`."""

from typing import Any

import numpy as np

from dynabot_mj.estimation import kalman, motion
from dynabot_mj.estimation.arrays import Array
from dynabot_mj.estimation.filterpy_twins.filters import MovingFilter, judged, sound
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
    turned,
)
from dynabot_mj.estimation.parameters import DEFAULT, Parameters


class CoupledEkf:
    """One filter of all ten states."""

    def __init__(self, parameters: Parameters = DEFAULT) -> None:
        """Starts anywhere; see `begin`."""
        self._parameters = parameters
        self._filter = MovingFilter(STATES, 4)
        self._fix_noise = np.diag([parameters.position_noise**2] * 2 + [parameters.velocity_noise**2] * 2)

    @property
    def filters(self) -> tuple[Any, ...]:
        """FilterPy's filter."""
        return (self._filter,)

    def sound(self) -> bool:
        """Tells whether all numbers are finite and all variances positive."""
        return sound(self._filter)

    def moments(self) -> tuple[Array, Array]:
        """Returns x, (10,), and P, (10, 10)."""
        return self._filter.x, self._filter.P

    def begin(self, fix: GpsFix, magnetic_heading: Array) -> None:
        """Starts with a first fix and magnetic heading."""
        p = self._parameters
        self._filter.x = np.zeros(STATES)
        self._filter.P = np.diag([0.0] * 5 + [p.yaw_rate_bias**2] + [p.acceleration_bias**2] * 2 + [0.0] * 2)
        self.believe_heading(magnetic_heading)
        self.believe_fix(fix)

    def predict(self, imu: ImuSample) -> None:
        """Carries the state over a period."""
        prediction = motion.predict(self._filter.x, imu, self._parameters)
        self._filter.moved = prediction.state
        self._filter.F, self._filter.Q = prediction.jacobian, prediction.noise
        self._filter.predict()

    def see_heading(self, magnetic_heading: Array) -> Update:
        """Takes a magnetic heading."""
        p, heading = self._parameters, self._filter.x[HEADING]
        observation = np.zeros((1, STATES))
        observation[0, HEADING] = 1.0
        return judged(
            self._filter,
            kalman.threshold(p.gate, 1),
            wrap(magnetic_heading - heading)[None],
            magnetic_heading[None],
            lambda x: observation,
            lambda x: x[HEADING : HEADING + 1],
            R=np.array([[p.bearing_noise**2]]),
            residual=lambda z, h: wrap(z - h),
        )

    def see_fix(self, fix: GpsFix, force_b: Array) -> tuple[Update, ...]:
        """Takes a fix: position and velocity at once."""
        reading, observation = motion.fix_model(self._filter.x, force_b, fix.age)
        z = np.concatenate([fix.position_w, fix.velocity_w])
        gate, noise = kalman.threshold(self._parameters.gate, 4), self._fix_noise
        return (judged(self._filter, gate, z - reading, z, lambda x: observation, lambda x: reading, R=noise),)

    def believe_heading(self, magnetic_heading: Array) -> None:
        """Sets the heading to a magnetic heading; the velocity over ground stays."""
        state = self._filter.x.copy()
        state[VELOCITY] = turned(rotation(state[HEADING] - magnetic_heading), state[VELOCITY])
        state[HEADING] = magnetic_heading
        self._filter.x = state
        self._forget({HEADING: self._parameters.bearing_noise**2})

    def believe_fix(self, fix: GpsFix) -> None:
        """Sets position and velocity to a fix, and the position's slow error to zero."""
        p, state = self._parameters, self._filter.x.copy()
        state[POSITION] = fix.position_w + fix.age * fix.velocity_w
        state[VELOCITY] = turned(rotation(-state[HEADING]), fix.velocity_w)
        state[POSITION_BIAS] = 0.0
        self._filter.x = state
        slow, velocity = p.position_bias**2, p.velocity_noise**2
        position = p.position_noise**2 + slow
        self._forget({0: position, 1: position, 2: velocity, 3: velocity, 8: slow, 9: slow})
        self._filter.P[[0, 1, 8, 9], [8, 9, 0, 1]] = -slow

    def beliefs(self) -> dict[str, Array]:
        """Returns the fields of `Estimate`."""
        x, covariance = self._filter.x, self._filter.P
        return {
            "position_w": x[POSITION],
            "velocity_w": turned(rotation(x[HEADING]), x[VELOCITY]),
            "heading": x[HEADING],
            "yaw_rate_bias": x[YAW_RATE_BIAS],
            "acceleration_bias_b": x[ACCELERATION_BIAS],
            "position_covariance": covariance[POSITION, POSITION],
            "velocity_covariance_b": covariance[VELOCITY, VELOCITY],
            "heading_variance": covariance[HEADING, HEADING],
        }

    def _forget(self, variances: dict[int, float]) -> None:
        """Cuts what is known of some states off from the rest."""
        covariance = self._filter.P.copy()
        for index, variance in variances.items():
            covariance[index, :] = covariance[:, index] = 0.0
            covariance[index, index] = variance
        self._filter.P = covariance
