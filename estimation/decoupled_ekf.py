"""The decoupled EKF (Sec. III.B): the ten states in sub-filters, each fed by the measurement that moves it most.

    {phi, b_r}                     Kalman filter on magnetic headings
    {v_x, v_y, b_ax, b_ay}         EKF on the fix's velocity; the heading is taken from its sibling
    {X, b_x}, {Y, b_y}             Kalman filters on the fix's position; the velocity is taken from its sibling

`dynabot circle --grouping` derives these groups from the gains of the coupled filter. What is dropped are the
covariances between the groups. The siblings' errors count as noise: the heading's in a velocity fix; the velocity's,
correlated over tau_v seconds, in the motion of the position, where its variance s^2 gives a density of 2 s^2 tau_v.
"""

from dataclasses import replace

import numpy as np

from dynabot_mj.estimation import kalman
from dynabot_mj.estimation.arrays import Array, BoolArray
from dynabot_mj.estimation.estimator import Rows
from dynabot_mj.estimation.heading_filter import HeadingFilter
from dynabot_mj.estimation.kalman import Update
from dynabot_mj.estimation.measurements import GpsFix, ImuSample, rotation
from dynabot_mj.estimation.motion import HEADING, STATES, YAW_RATE_BIAS, left, turned
from dynabot_mj.estimation.parameters import DEFAULT, Parameters

# The sub-filters by the names of `dynabot_mj.estimation.motion.NAMES`.
GROUPS = (("X", "b_x"), ("Y", "b_y"), ("v_x", "v_y", "b_ax", "b_ay"), ("phi", "b_r"))


class DecoupledEkf:
    """The sub-filters of M robots."""

    def __init__(self, count: int, parameters: Parameters = DEFAULT) -> None:
        """Starts anywhere; see `begin`.

        Args:
            count: M.
            parameters: Assumed errors.
        """
        self._parameters = parameters
        self.heading = HeadingFilter(count, parameters)
        self.velocity = np.zeros((count, 4))  # v_x, v_y, b_ax, b_ay
        self.velocity_covariance = np.tile(np.eye(4), (count, 1, 1))
        # Two filters alike, X's and Y's: (M, 2, .) with the states position and slow error behind.
        self.position = np.zeros((count, 2, 2))
        self.position_covariance = np.tile(np.eye(2), (count, 2, 1, 1))

    def begin(self, rows: Rows, fix: GpsFix, magnetic_heading: Array) -> None:
        """Starts with a first fix and magnetic heading."""
        self.heading.begin(rows, magnetic_heading)
        self.velocity[rows, 2:] = 0.0
        self.velocity_covariance[rows] = np.eye(4) * self._parameters.acceleration_bias**2
        self.believe_fix(rows, fix)

    def predict(self, rows: Rows, imu: ImuSample) -> None:
        """Carries all sub-filters over a period."""
        p, t = self._parameters, imu.period[:, None]
        velocity, covariance = self.velocity[rows], self.velocity_covariance[rows]
        heading = self.heading.state[rows, 0].copy()  # a slice gives a view, and the sibling moves on below
        velocity_w = turned(rotation(heading), velocity[:, :2])
        spread_w = self._spread_w(rows, velocity_w)
        yaw_rate = self.heading.predict(rows, imu)

        turn = rotation(-yaw_rate * imu.period)
        half_turn = rotation(-0.5 * yaw_rate * imu.period)
        force_b = imu.specific_force_b - velocity[:, 2:]
        force_w = turned(rotation(heading + 0.5 * yaw_rate * imu.period), force_b)
        turned_v, turned_f = turned(turn, velocity[:, :2]), turned(half_turn, force_b)
        decay = np.exp(-t / p.acceleration_bias_time)
        jacobian = np.zeros((len(velocity), 4, 4))
        jacobian[:, :2, :2] = turn
        jacobian[:, :2, 2:] = -t[..., None] * half_turn
        jacobian[:, [2, 3], [2, 3]] = decay
        noise = np.zeros_like(jacobian)
        swing = t * left(turned_v) + 0.5 * t**2 * left(turned_f)  # by an error of the yaw rate
        noise[:, :2, :2] = _outer(swing) * (p.yaw_rate_density**2 / np.maximum(t, 1e-9))[..., None]
        noise[:, [0, 1], [0, 1]] += p.acceleration_density**2 * t
        noise[:, [2, 3], [2, 3]] = p.acceleration_bias**2 * (1.0 - decay**2)
        self.velocity[rows] = np.concatenate([turned_v + t * turned_f, decay * velocity[:, 2:]], axis=-1)
        self.velocity_covariance[rows] = kalman.propagate(covariance, jacobian, noise)

        slow = np.exp(-t / p.position_bias_time)
        position, spread = self.position[rows], self.position_covariance[rows]
        position[..., 0] += t * velocity_w + 0.5 * t**2 * force_w
        position[..., 1] *= slow
        spread[..., 0, 0] += 2.0 * spread_w * p.velocity_error_time * t + p.position_density**2 * t
        spread[..., 0, 1] *= slow
        spread[..., 1, 0] = spread[..., 0, 1]
        spread[..., 1, 1] = slow**2 * spread[..., 1, 1] + p.position_bias**2 * (1.0 - slow**2)
        self.position[rows], self.position_covariance[rows] = position, spread

    def see_heading(self, rows: Rows, magnetic_heading: Array) -> Update:
        """Takes a magnetic heading."""
        return self.heading.see_heading(rows, magnetic_heading)

    def see_fix(self, rows: Rows, fix: GpsFix, force_b: Array) -> tuple[Update, ...]:
        """Takes a fix: the velocity, then both components of the position."""
        p, age = self._parameters, fix.age[:, None]
        velocity = self.velocity[rows]
        to_world = rotation(self.heading.state[rows, 0])
        velocity_w = turned(to_world, velocity[:, :2])
        force_w = turned(to_world, force_b - velocity[:, 2:])
        uncertain = self.heading.covariance[rows, 0, 0][:, None, None] * _outer(left(velocity_w))
        swift = kalman.update(
            velocity,
            self.velocity_covariance[rows],
            fix.velocity_w - (velocity_w - age * force_w),
            np.concatenate([to_world, age[..., None] * to_world], axis=-1),
            p.velocity_noise**2 * np.eye(2) + uncertain,
            kalman.threshold(p.gate, 2),
        )
        self.velocity[rows], self.velocity_covariance[rows] = swift.state, swift.covariance

        # The past position, reached back with the velocity as it is now known.
        velocity = swift.state
        velocity_w = turned(to_world, velocity[:, :2])
        force_w = turned(to_world, force_b - velocity[:, 2:])
        past_w = fix.position_w + age * velocity_w - 0.5 * age**2 * force_w
        noise = p.position_noise**2 + age**2 * self._spread_w(rows, velocity_w)
        position, covariance = self.position[rows], self.position_covariance[rows]
        both = [
            kalman.update(
                position[:, axis],
                covariance[:, axis],
                (past_w[:, axis] - position[:, axis].sum(axis=-1))[:, None],
                np.ones((len(position), 1, 2)),
                noise[:, axis, None, None],
                np.inf,
            )
            for axis in (0, 1)
        ]
        # Both components come from one fix, so they are believed or rejected together.
        inside = both[0].squared + both[1].squared <= kalman.threshold(p.gate, 2)
        for axis, one in enumerate(both):
            position[:, axis] = np.where(inside[:, None], one.state, position[:, axis])
            covariance[:, axis] = np.where(inside[:, None, None], one.covariance, covariance[:, axis])
        self.position[rows], self.position_covariance[rows] = position, covariance
        return swift, *(replace(one, accepted=inside) for one in both)

    def believe_heading(self, rows: Rows, magnetic_heading: Array) -> None:
        """Sets the heading to a magnetic one; body axes turn under the velocity, which stays what it is over ground."""
        turn = rotation(self.heading.state[rows, 0] - magnetic_heading)
        self.velocity[rows, :2] = turned(turn, self.velocity[rows, :2])
        self.heading.believe(rows, magnetic_heading)

    def believe_fix(self, rows: Rows, fix: GpsFix) -> None:
        """Sets position and velocity to a fix, and the position's slow error to zero."""
        p = self._parameters
        self.velocity[rows, :2] = turned(rotation(-self.heading.state[rows, 0]), fix.velocity_w)
        covariance = self.velocity_covariance[rows]
        covariance[:, :2, :] = covariance[:, :, :2] = 0.0
        covariance[:, [0, 1], [0, 1]] = p.velocity_noise**2
        self.velocity_covariance[rows] = covariance
        self.position[rows, :, 0] = fix.position_w + fix.age[:, None] * fix.velocity_w
        self.position[rows, :, 1] = 0.0
        slow = p.position_bias**2
        self.position_covariance[rows] = np.array([[p.position_noise**2 + slow, -slow], [-slow, slow]])

    def sound(self) -> BoolArray:
        """Tells where all numbers are finite and all variances positive."""
        states = np.concatenate([self.heading.state, self.velocity, self.position.reshape(-1, 4)], axis=-1)
        variances = np.concatenate(
            [
                np.diagonal(self.heading.covariance, axis1=1, axis2=2),
                np.diagonal(self.velocity_covariance, axis1=1, axis2=2),
                np.diagonal(self.position_covariance, axis1=2, axis2=3).reshape(-1, 4),
            ],
            axis=-1,
        )
        return np.isfinite(states.sum(axis=-1)) & (variances > 0.0).all(axis=-1) & (variances < 1e8).all(axis=-1)

    def beliefs(self) -> dict[str, Array]:
        """Returns the fields of `Estimate`."""
        heading = self.heading.state[:, 0]
        return {
            "position_w": self.position[..., 0].copy(),
            "velocity_w": turned(rotation(heading), self.velocity[:, :2]),
            "heading": heading.copy(),
            "yaw_rate_bias": self.heading.state[:, 1].copy(),
            "acceleration_bias_b": self.velocity[:, 2:].copy(),
            "position_covariance": self.position_covariance[..., 0, 0, None] * np.eye(2),
            "velocity_covariance_b": self.velocity_covariance[:, :2, :2].copy(),
            "heading_variance": self.heading.covariance[:, 0, 0].copy(),
        }

    def moments(self) -> tuple[Array, Array]:
        """Returns the states in the order of `motion.NAMES`, (M, 10), and their covariance, in blocks."""
        state, covariance = np.zeros((len(self.velocity), STATES)), np.zeros((len(self.velocity), STATES, STATES))
        parts = [
            ([HEADING, YAW_RATE_BIAS], self.heading.state, self.heading.covariance),
            ([2, 3, 6, 7], self.velocity, self.velocity_covariance),
            *(([axis, 8 + axis], self.position[:, axis], self.position_covariance[:, axis]) for axis in (0, 1)),
        ]
        for indices, mean, spread in parts:
            state[:, indices] = mean
            covariance[:, np.array(indices)[:, None], indices] = spread
        return state, covariance

    def _spread_w(self, rows: Rows, velocity_w: Array) -> Array:
        """Returns the variances of the velocity over ground along the world's axes, heading included, (M, 2)."""
        to_world = rotation(self.heading.state[rows, 0])
        own = ((to_world @ self.velocity_covariance[rows, :2, :2]) * to_world).sum(axis=-1)
        return own + self.heading.covariance[rows, 0, 0][:, None] * left(velocity_w) ** 2


def _outer(vector: Array) -> Array:
    """Returns u u^T, (M, 2, 2)."""
    return vector[:, :, None] * vector[:, None, :]
