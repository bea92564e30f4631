"""The same three filters on FilterPy's own Kalman filters, one robot at a time.

The batched filters write predict and update out for all robots at once; here FilterPy computes them, with dense
matrices. So these are what the batched filters are tested against, and what a filter costs on a robot.

What FilterPy does not do by itself: its Kalman filter subtracts angles without wrapping, so a bearing is passed as
x_0 + wrap(z - x_0); its EKF moves the state by the matrix F, so `predict_x` is overridden; and both take whatever they
are given, so an update whose own innovation is not finite or lies beyond the gate is taken back.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
from filterpy.kalman import ExtendedKalmanFilter, KalmanFilter

from estimation import kalman, motion
from estimation.kalman import Update
from estimation.measurements import GpsFix, ImuSample, rotation, wrap
from estimation.motion import (
    ACCELERATION_BIAS,
    HEADING,
    POSITION,
    POSITION_BIAS,
    STATES,
    VELOCITY,
    YAW_RATE_BIAS,
    left,
    turned,
)
from estimation.parameters import DEFAULT, Parameters

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class _Part:
    """One of FilterPy's filters, and which of the ten states of `estimation.motion` are its own."""

    filter: Any  # FilterPy has no types; its x, P are (s,), (s, s)
    states: list[int]

    def judged(self, take: Callable[[], None], innovation: Array, gate: float) -> Update:
        """Lets FilterPy take a measurement, and takes it back where FilterPy's own innovation fails the gate."""
        before = self.filter.x, self.filter.P  # FilterPy makes new arrays at every update
        take()
        squared = self.filter.y @ self.filter.SI @ self.filter.y
        accepted = squared <= gate  # not so where it is NaN
        if not accepted:
            self.filter.x, self.filter.P = before
        return Update(
            state=self.filter.x,
            covariance=self.filter.P,
            innovation=innovation,
            innovation_covariance=self.filter.S,
            squared=squared,
            accepted=accepted,
        )


def _sound(part: _Part) -> bool:
    """Tells whether all numbers are finite and all variances positive, as the batched filters do."""
    variances = np.diagonal(part.filter.P)
    return bool(np.isfinite(part.filter.x).all() and (variances > 0.0).all() and (variances < 1e8).all())


class _MovingFilter(ExtendedKalmanFilter):  # type: ignore[misc] # FilterPy has no types
    """FilterPy's EKF with the state moved by the model itself, not by its Jacobian."""

    moved: Array

    def predict_x(self, u: object = 0) -> None:
        self.x = self.moved


def _kalman_filter(states: int, covariance: Array, observation: list[float]) -> Any:
    """Returns FilterPy's filter of some states, 1-D and at zero, with one measurement."""
    found = KalmanFilter(dim_x=states, dim_z=1)
    found.x, found.P, found.H = np.zeros(states), covariance, np.array([observation])
    return found


def _moving_filter(covariance: Array, components: int) -> Any:
    """Returns FilterPy's EKF, 1-D and at zero: in its default, 2-D form a 1-D z would be broadcast."""
    found = _MovingFilter(dim_x=len(covariance), dim_z=components)
    found.x, found.P = np.zeros(len(covariance)), covariance
    return found


class _Heading:
    """x = [phi, b_r]; see `estimation.heading_filter`."""

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters
        start = np.diag([parameters.bearing_noise**2, parameters.yaw_rate_bias**2])
        self.filter = _kalman_filter(2, start, [1.0, 0.0])
        self.part = _Part(filter=self.filter, states=[HEADING, YAW_RATE_BIAS])

    def begin(self, bearing: Array) -> None:
        p = self._parameters
        self.filter.x = np.array([bearing, 0.0])
        self.filter.P = np.diag([p.bearing_noise**2, p.yaw_rate_bias**2])

    def believe(self, bearing: Array) -> None:
        bias_variance = self.filter.P[1, 1]
        self.filter.x = np.array([bearing, self.filter.x[1]])
        self.filter.P = np.diag([self._parameters.bearing_noise**2, bias_variance])

    def predict(self, imu: ImuSample) -> Array:
        p, t = self._parameters, imu.period
        yaw_rate: Array = imu.yaw_rate - self.filter.x[1]
        self.filter.predict(
            u=imu.yaw_rate[None],
            B=np.array([[t], [0.0]]),
            F=np.array([[1.0, -t], [0.0, 1.0]]),
            Q=np.diag([p.yaw_rate_density**2 * t, p.yaw_rate_bias_walk**2 * t]),
        )
        return yaw_rate

    def see_bearing(self, bearing: Array) -> Update:
        p, heading = self._parameters, self.filter.x[0]
        innovation = wrap(bearing - heading)
        noise = np.array([[p.bearing_noise**2]])
        return self.part.judged(
            lambda: self.filter.update(heading + innovation, R=noise), innovation[None], kalman.threshold(p.gate, 1)
        )


class GpsExtrapolation:
    """The twin of `estimation.gps_extrapolation`: only its heading is FilterPy's."""

    def __init__(self, parameters: Parameters = DEFAULT) -> None:
        """Starts anywhere; see `begin`."""
        self._parameters = parameters
        self._heading = _Heading(parameters)
        self._motion = np.zeros(4)  # position and velocity over ground
        self._age = np.zeros(())

    @property
    def filters(self) -> tuple[Any, ...]:
        """FilterPy's filters."""
        return (self._heading.filter,)

    def sound(self) -> bool:
        """Tells whether all numbers are finite and all variances positive."""
        return _sound(self._heading.part) and bool(np.isfinite(self._motion).all())

    def begin(self, fix: GpsFix, bearing: Array) -> None:
        """Starts with a first fix and bearing."""
        self._heading.begin(bearing)
        self.believe_fix(fix)

    def predict(self, imu: ImuSample) -> None:
        """Carries position and heading over a period."""
        self._heading.predict(imu)
        position_w, velocity_w = self._motion[:2], self._motion[2:]
        self._motion = np.concatenate([position_w + imu.period * velocity_w, velocity_w])
        self._age = self._age + imu.period

    def see_bearing(self, bearing: Array) -> Update:
        """Takes a bearing."""
        return self._heading.see_bearing(bearing)

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

    def believe_bearing(self, bearing: Array) -> None:
        """Sets the heading to a bearing."""
        self._heading.believe(bearing)

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


class DecoupledEkf:
    """The twin of `estimation.decoupled_ekf`."""

    def __init__(self, parameters: Parameters = DEFAULT) -> None:
        """Starts anywhere; see `begin`."""
        self._parameters = parameters
        self._heading = _Heading(parameters)
        self._velocity = _Part(filter=_moving_filter(np.eye(4), 2), states=[2, 3, 6, 7])
        self._position = tuple(
            _Part(filter=_kalman_filter(2, np.eye(2), [1.0, 1.0]), states=[axis, 8 + axis]) for axis in (0, 1)
        )
        self._parts = (self._heading.part, self._velocity, *self._position)

    @property
    def filters(self) -> tuple[Any, ...]:
        """FilterPy's filters."""
        return tuple(part.filter for part in self._parts)

    def sound(self) -> bool:
        """Tells whether all numbers are finite and all variances positive."""
        return all(map(_sound, self._parts))

    def moments(self) -> tuple[Array, Array]:
        """Returns the ten states, (10,), and their covariance, (10, 10), in blocks."""
        state, covariance = np.zeros(STATES), np.zeros((STATES, STATES))
        for part in self._parts:
            state[part.states] = part.filter.x
            covariance[np.ix_(part.states, part.states)] = part.filter.P
        return state, covariance

    def begin(self, fix: GpsFix, bearing: Array) -> None:
        """Starts with a first fix and bearing."""
        self._heading.begin(bearing)
        self._velocity.filter.x = np.zeros(4)
        self._velocity.filter.P = np.eye(4) * self._parameters.acceleration_bias**2
        self.believe_fix(fix)

    def predict(self, imu: ImuSample) -> None:
        """Carries all sub-filters over a period."""
        p, t, state = self._parameters, imu.period, self._velocity.filter.x
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
            part.filter.predict(
                u=moved_w[axis : axis + 1],
                B=np.array([[1.0], [0.0]]),
                F=np.diag([1.0, slow]),
                Q=np.diag([grown[axis], p.position_bias**2 * (1.0 - slow**2)]),
            )

    def see_bearing(self, bearing: Array) -> Update:
        """Takes a bearing."""
        return self._heading.see_bearing(bearing)

    def see_fix(self, fix: GpsFix, force_b: Array) -> tuple[Update, ...]:
        """Takes a fix: the velocity, then both components of the position."""
        p, age = self._parameters, fix.age
        swift = self._see_velocity(fix, force_b)
        # The past position, reached back with the velocity as it is now known.
        to_world, state = rotation(self._heading.filter.x[0]), self._velocity.filter.x
        velocity_w = turned(to_world, state[:2])
        force_w = turned(to_world, force_b - state[2:])
        past_w = fix.position_w + age * velocity_w - 0.5 * age**2 * force_w
        noise = p.position_noise**2 + age**2 * self._spread_w(velocity_w)
        before = [(part.filter.x, part.filter.P) for part in self._position]
        both = [self._see_position(axis, past_w[axis], noise[axis]) for axis in (0, 1)]
        # Both components come from one fix, so they are believed or rejected together.
        inside = both[0].squared + both[1].squared <= kalman.threshold(p.gate, 2)
        if not inside:
            for part, (state, covariance) in zip(self._position, before, strict=True):
                part.filter.x, part.filter.P = state, covariance
        return swift, *(replace(one, accepted=inside) for one in both)

    def believe_bearing(self, bearing: Array) -> None:
        """Sets the heading to a bearing; the velocity over ground stays."""
        turn = rotation(self._heading.filter.x[0] - bearing)
        state = self._velocity.filter.x
        self._velocity.filter.x = np.concatenate([turned(turn, state[:2]), state[2:]])
        self._heading.believe(bearing)

    def believe_fix(self, fix: GpsFix) -> None:
        """Sets position and velocity to a fix, and the position's slow error to zero."""
        p, swift = self._parameters, self._velocity.filter
        velocity_b = turned(rotation(-self._heading.filter.x[0]), fix.velocity_w)
        bias_covariance = swift.P[2:, 2:]
        swift.x = np.concatenate([velocity_b, swift.x[2:]])
        swift.P = p.velocity_noise**2 * np.eye(4)
        swift.P[2:, 2:] = bias_covariance
        slow, here_w = p.position_bias**2, fix.position_w + fix.age * fix.velocity_w
        for axis, part in enumerate(self._position):
            part.filter.x = np.array([here_w[axis], 0.0])
            part.filter.P = np.array([[p.position_noise**2 + slow, -slow], [-slow, slow]])

    def beliefs(self) -> dict[str, Array]:
        """Returns the fields of `Estimate`."""
        heading, swift = self._heading.filter, self._velocity.filter
        return {
            "position_w": np.array([part.filter.x[0] for part in self._position]),
            "velocity_w": turned(rotation(heading.x[0]), swift.x[:2]),
            "heading": heading.x[0],
            "yaw_rate_bias": heading.x[1],
            "acceleration_bias_b": swift.x[2:],
            "position_covariance": np.diag([part.filter.P[0, 0] for part in self._position]),
            "velocity_covariance_b": swift.P[:2, :2],
            "heading_variance": heading.P[0, 0],
        }

    def _predict_velocity(self, t: Array, yaw_rate: Array, force_b: Array) -> None:
        p, swift = self._parameters, self._velocity.filter
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
        p, swift, age = self._parameters, self._velocity.filter, fix.age
        to_world = rotation(self._heading.filter.x[0])
        velocity_w = turned(to_world, swift.x[:2])
        reading = velocity_w - age * turned(to_world, force_b - swift.x[2:])
        observation = np.concatenate([to_world, age * to_world], axis=1)
        across = left(velocity_w)
        noise = p.velocity_noise**2 * np.eye(2) + self._heading.filter.P[0, 0] * np.outer(across, across)
        return self._velocity.judged(
            lambda: swift.update(fix.velocity_w, lambda x: observation, lambda x: reading, R=noise),
            fix.velocity_w - reading,
            kalman.threshold(p.gate, 2),
        )

    def _see_position(self, axis: int, past: Array, noise: Array) -> Update:
        part = self._position[axis]
        innovation = past - part.filter.x.sum()
        return part.judged(lambda: part.filter.update(past, R=noise.reshape(1, 1)), innovation[None], np.inf)

    def _spread_w(self, velocity_w: Array) -> Array:
        """Returns the variances of the velocity over ground along the world's axes, heading included, (2,)."""
        to_world = rotation(self._heading.filter.x[0])
        own = np.diagonal(to_world @ self._velocity.filter.P[:2, :2] @ to_world.T)
        return own + self._heading.filter.P[0, 0] * left(velocity_w) ** 2


class CoupledEkf:
    """The twin of `estimation.coupled_ekf`."""

    def __init__(self, parameters: Parameters = DEFAULT) -> None:
        """Starts anywhere; see `begin`."""
        self._parameters = parameters
        self._filter = _moving_filter(np.eye(STATES), 4)
        self._part = _Part(filter=self._filter, states=list(range(STATES)))
        self._fix_noise = np.diag([parameters.position_noise**2] * 2 + [parameters.velocity_noise**2] * 2)

    @property
    def filters(self) -> tuple[Any, ...]:
        """FilterPy's filter."""
        return (self._filter,)

    def sound(self) -> bool:
        """Tells whether all numbers are finite and all variances positive."""
        return _sound(self._part)

    def moments(self) -> tuple[Array, Array]:
        """Returns x, (10,), and P, (10, 10)."""
        return self._filter.x, self._filter.P

    def begin(self, fix: GpsFix, bearing: Array) -> None:
        """Starts with a first fix and bearing."""
        p = self._parameters
        self._filter.x = np.zeros(STATES)
        self._filter.P = np.diag([0.0] * 5 + [p.yaw_rate_bias**2] + [p.acceleration_bias**2] * 2 + [0.0] * 2)
        self.believe_bearing(bearing)
        self.believe_fix(fix)

    def predict(self, imu: ImuSample) -> None:
        """Carries the state over a period."""
        prediction = motion.predict(self._filter.x, imu, self._parameters)
        self._filter.moved = prediction.state
        self._filter.F, self._filter.Q = prediction.jacobian, prediction.noise
        self._filter.predict()

    def see_bearing(self, bearing: Array) -> Update:
        """Takes a bearing."""
        p, heading = self._parameters, self._filter.x[HEADING]
        observation = np.zeros((1, STATES))
        observation[0, HEADING] = 1.0
        return self._part.judged(
            lambda: self._filter.update(
                bearing[None],
                lambda x: observation,
                lambda x: x[HEADING : HEADING + 1],
                R=np.array([[p.bearing_noise**2]]),
                residual=lambda z, h: wrap(z - h),
            ),
            wrap(bearing - heading)[None],
            kalman.threshold(p.gate, 1),
        )

    def see_fix(self, fix: GpsFix, force_b: Array) -> tuple[Update, ...]:
        """Takes a fix: position and velocity at once."""
        reading, observation = motion.fix_model(self._filter.x, force_b, fix.age)
        z = np.concatenate([fix.position_w, fix.velocity_w])
        update = self._part.judged(
            lambda: self._filter.update(z, lambda x: observation, lambda x: reading, R=self._fix_noise),
            z - reading,
            kalman.threshold(self._parameters.gate, 4),
        )
        return (update,)

    def believe_bearing(self, bearing: Array) -> None:
        """Sets the heading to a bearing; the velocity over ground stays."""
        state = self._filter.x.copy()
        state[VELOCITY] = turned(rotation(state[HEADING] - bearing), state[VELOCITY])
        state[HEADING] = bearing
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
