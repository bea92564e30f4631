"""The twin of `dynabot_mj.estimation.decoupled_ekf`."""

from dataclasses import replace
from typing import Any

import numpy as np

from dynabot_mj.estimation import kalman
from dynabot_mj.estimation.arrays import Array
from dynabot_mj.estimation.filterpy_twins.filters import MovingFilter, judged, linear, sound
from dynabot_mj.estimation.filterpy_twins.heading_filter import HeadingFilter
from dynabot_mj.estimation.kalman import Update
from dynabot_mj.estimation.measurements import GpsFix, ImuSample, rotation
from dynabot_mj.estimation.motion import HEADING, STATES, YAW_RATE_BIAS, left, turned
from dynabot_mj.estimation.parameters import DEFAULT, Parameters

# Which of the ten states of `dynabot_mj.estimation.motion` the sub-filters have.
_STATES = ((HEADING, YAW_RATE_BIAS), (2, 3, 6, 7), (0, 8), (1, 9))


class DecoupledEkf:
    """The sub-filters of one robot."""

    def __init__(self, parameters: Parameters = DEFAULT) -> None:
        """Starts anywhere; see `begin`."""
        self._parameters = parameters
        self._heading = HeadingFilter(parameters)
        self._velocity = MovingFilter(4, 2)  # v_x, v_y, b_ax, b_ay
        self._position = (linear(1.0, 1.0), linear(1.0, 1.0))  # X, b_x and Y, b_y

    @property
    def filters(self) -> tuple[Any, ...]:
        """FilterPy's filters."""
        return (self._heading.filter, self._velocity, *self._position)

    def sound(self) -> bool:
        """Tells whether all numbers are finite and all variances positive."""
        return all(map(sound, self.filters))

    def moments(self) -> tuple[Array, Array]:
        """Returns the ten states, (10,), and their covariance, (10, 10), in blocks."""
        state, covariance = np.zeros(STATES), np.zeros((STATES, STATES))
        for one, states in zip(self.filters, _STATES, strict=True):
            state[list(states)] = one.x
            covariance[np.ix_(states, states)] = one.P
        return state, covariance

    def begin(self, fix: GpsFix, magnetic_heading: Array) -> None:
        """Starts with a first fix and magnetic heading."""
        self._heading.begin(magnetic_heading)
        self._velocity.x = np.zeros(4)
        self._velocity.P = np.eye(4) * self._parameters.acceleration_bias**2
        self.believe_fix(fix)

    def predict(self, imu: ImuSample) -> None:
        """Carries all sub-filters over a period."""
        p, t, state = self._parameters, imu.period, self._velocity.x
        heading = self._heading.filter.x[0]
        velocity_w = turned(rotation(heading), state[:2])
        spread_w = self._spread_w(velocity_w)
        yaw_rate = self._heading.predict(imu)
        force_b = imu.specific_force_b - state[2:]
        force_w = turned(rotation(heading + 0.5 * yaw_rate * t), force_b)
        self._predict_velocity(t, yaw_rate, force_b)

        slow = np.exp(-t / p.position_bias_time)
        moved_w = t * velocity_w + 0.5 * t**2 * force_w
        grown = 2.0 * spread_w * p.velocity_error_time * t + p.position_density**2 * t
        for axis, part in enumerate(self._position):
            part.predict(
                u=moved_w[axis : axis + 1],
                B=np.array([[1.0], [0.0]]),
                F=np.diag([1.0, slow]),
                Q=np.diag([grown[axis], p.position_bias**2 * (1.0 - slow**2)]),
            )

    def see_heading(self, magnetic_heading: Array) -> Update:
        """Takes a magnetic heading."""
        return self._heading.see_heading(magnetic_heading)

    def see_fix(self, fix: GpsFix, force_b: Array) -> tuple[Update, ...]:
        """Takes a fix: the velocity, then both components of the position."""
        p, age = self._parameters, fix.age
        swift = self._see_velocity(fix, force_b)
        # The past position, reached back with the velocity as it is now known.
        to_world, state = rotation(self._heading.filter.x[0]), self._velocity.x
        velocity_w = turned(to_world, state[:2])
        force_w = turned(to_world, force_b - state[2:])
        past_w = fix.position_w + age * velocity_w - 0.5 * age**2 * force_w
        noise = p.position_noise**2 + age**2 * self._spread_w(velocity_w)
        before = [(part.x, part.P) for part in self._position]
        both = [self._see_position(axis, past_w[axis], noise[axis]) for axis in (0, 1)]
        # Both components come from one fix, so they are believed or rejected together.
        inside = both[0].squared + both[1].squared <= kalman.threshold(p.gate, 2)
        if not inside:
            for part, (state, covariance) in zip(self._position, before, strict=True):
                part.x, part.P = state, covariance
        return swift, *(replace(one, accepted=inside) for one in both)

    def believe_heading(self, magnetic_heading: Array) -> None:
        """Sets the heading to a magnetic heading; the velocity over ground stays."""
        turn = rotation(self._heading.filter.x[0] - magnetic_heading)
        state = self._velocity.x
        self._velocity.x = np.concatenate([turned(turn, state[:2]), state[2:]])
        self._heading.believe(magnetic_heading)

    def believe_fix(self, fix: GpsFix) -> None:
        """Sets position and velocity to a fix, and the position's slow error to zero."""
        p, swift = self._parameters, self._velocity
        velocity_b = turned(rotation(-self._heading.filter.x[0]), fix.velocity_w)
        bias_covariance = swift.P[2:, 2:]
        swift.x = np.concatenate([velocity_b, swift.x[2:]])
        swift.P = p.velocity_noise**2 * np.eye(4)
        swift.P[2:, 2:] = bias_covariance
        slow, here_w = p.position_bias**2, fix.position_w + fix.age * fix.velocity_w
        for axis, part in enumerate(self._position):
            part.x = np.array([here_w[axis], 0.0])
            part.P = np.array([[p.position_noise**2 + slow, -slow], [-slow, slow]])

    def beliefs(self) -> dict[str, Array]:
        """Returns the fields of `Estimate`."""
        heading, swift = self._heading.filter, self._velocity
        return {
            "position_w": np.array([part.x[0] for part in self._position]),
            "velocity_w": turned(rotation(heading.x[0]), swift.x[:2]),
            "heading": heading.x[0],
            "yaw_rate_bias": heading.x[1],
            "acceleration_bias_b": swift.x[2:],
            "position_covariance": np.diag([part.P[0, 0] for part in self._position]),
            "velocity_covariance_b": swift.P[:2, :2],
            "heading_variance": heading.P[0, 0],
        }

    def _predict_velocity(self, t: Array, yaw_rate: Array, force_b: Array) -> None:
        p, swift = self._parameters, self._velocity
        turn, half_turn = rotation(-yaw_rate * t), rotation(-0.5 * yaw_rate * t)
        turned_v, turned_f = turned(turn, swift.x[:2]), turned(half_turn, force_b)
        decay = np.exp(-t / p.acceleration_bias_time)
        swift.moved = np.concatenate([turned_v + t * turned_f, decay * swift.x[2:]])
        swift.F = np.diag([1.0, 1.0, decay, decay])
        swift.F[:2, :2], swift.F[:2, 2:] = turn, -t * half_turn
        swing = t * left(turned_v) + 0.5 * t**2 * left(turned_f)  # by an error of the yaw rate
        white = np.outer(swing, swing) * (p.yaw_rate_density**2 / np.maximum(t, 1e-9))
        force, drift = p.acceleration_density**2 * t, p.acceleration_bias**2 * (1.0 - decay**2)
        swift.Q = np.diag([force, force, drift, drift])
        swift.Q[:2, :2] += white
        swift.predict()

    def _see_velocity(self, fix: GpsFix, force_b: Array) -> Update:
        p, swift, age = self._parameters, self._velocity, fix.age
        to_world = rotation(self._heading.filter.x[0])
        velocity_w = turned(to_world, swift.x[:2])
        reading = velocity_w - age * turned(to_world, force_b - swift.x[2:])
        observation = np.concatenate([to_world, age * to_world], axis=1)
        across = left(velocity_w)
        noise = p.velocity_noise**2 * np.eye(2) + self._heading.filter.P[0, 0] * np.outer(across, across)
        return judged(
            swift,
            kalman.threshold(p.gate, 2),
            fix.velocity_w - reading,
            fix.velocity_w,
            lambda x: observation,
            lambda x: reading,
            R=noise,
        )

    def _see_position(self, axis: int, past: Array, noise: Array) -> Update:
        part = self._position[axis]
        innovation = past - part.x.sum()
        return judged(part, np.inf, innovation[None], past, R=noise.reshape(1, 1))

    def _spread_w(self, velocity_w: Array) -> Array:
        """Returns the variances of the velocity over ground along the world's axes, heading included, (2,)."""
        to_world = rotation(self._heading.filter.x[0])
        own = np.diagonal(to_world @ self._velocity.P[:2, :2] @ to_world.T)
        return own + self._heading.filter.P[0, 0] * left(velocity_w) ** 2
