"""Process and measurement models of the robots, with their Jacobians, common to all estimators.

States, with body axes x ahead and y to the left, as in Sec. III.B of the paper:

    x = [X, Y, v_x, v_y, phi, b_r, b_ax, b_ay, b_x, b_y],

position and body velocity, heading, and the biases of gyro, accelerometer and GPS position. The inputs are the mean
specific force a and yaw rate w of a period T; with r = w - b_r, a' = a - b_a, and R(.) turning to the left:

    v'   = R(-r T) v + T R(-r T / 2) a'              body axes turn by r T while the velocity changes by T a'
    p'   = p + T V + T^2 / 2 A,                      V = R(phi) v,   A = R(phi + r T / 2) a'
    phi' = phi + r T
    b'   = exp(-T / tau) b                           each bias a Gauss-Markov sequence, b_r a random walk

which is exact while r and the acceleration along the mean heading are constant; Euler's rule is not at 156 ms.

A GPS fix of age L sees the past, reached back with the motion of now, and the position with its slow error:

    h = [p + b - L V + L^2 / 2 A;   V - L A],        A = R(phi) a'.

A magnetic heading sees phi; its innovation is wrapped.
"""

from dataclasses import dataclass

import numpy as np

from dynabot_mj.estimation.arrays import Array
from dynabot_mj.estimation.measurements import ImuSample, rotation
from dynabot_mj.estimation.parameters import Parameters

# Where the parts of x are.
POSITION, VELOCITY, HEADING = slice(0, 2), slice(2, 4), 4
YAW_RATE_BIAS, ACCELERATION_BIAS, POSITION_BIAS = 5, slice(6, 8), slice(8, 10)
STATES = 10
NAMES = ("X", "Y", "v_x", "v_y", "phi", "b_r", "b_ax", "b_ay", "b_x", "b_y")


@dataclass(frozen=True, kw_only=True)
class Prediction:
    """The state after a period, and how it depends on the state before."""

    state: Array  # (..., 10)
    jacobian: Array  # (..., 10, 10)
    noise: Array  # (..., 10, 10) covariance that the period adds


def predict(state: Array, imu: ImuSample, parameters: Parameters) -> Prediction:
    """Carries the ten states over a sampling period.

    Args:
        state: x, (..., 10).
        imu: Its averages over the period, finite.
        parameters: Of the noise.

    Returns:
        The prediction; at period 0 that of no time passing.
    """
    time = imu.period
    v, phi = state[..., VELOCITY], state[..., HEADING]
    r = imu.yaw_rate - state[..., YAW_RATE_BIAS]
    a = imu.specific_force_b - state[..., ACCELERATION_BIAS]
    t = time[..., None]
    to_world, mid_to_world = rotation(phi), rotation(phi + 0.5 * r * time)
    turn, half_turn = rotation(-r * time), rotation(-0.5 * r * time)
    v_w, a_w = turned(to_world, v), turned(mid_to_world, a)
    turned_v, turned_a = turned(turn, v), turned(half_turn, a)

    decay = np.ones((*time.shape, STATES))
    decay[..., ACCELERATION_BIAS] = np.exp(-t / parameters.acceleration_bias_time)
    decay[..., POSITION_BIAS] = np.exp(-t / parameters.position_bias_time)
    after = decay * state
    after[..., POSITION] = state[..., POSITION] + t * v_w + 0.5 * t**2 * a_w
    after[..., VELOCITY] = turned_v + t * turned_a
    after[..., HEADING] = phi + time * r

    jacobian = np.zeros((*time.shape, STATES, STATES))
    jacobian[..., range(STATES), range(STATES)] = decay
    tt = t[..., None]
    jacobian[..., POSITION, VELOCITY] = tt * to_world
    jacobian[..., POSITION, HEADING] = t * left(v_w) + 0.5 * t**2 * left(a_w)
    jacobian[..., POSITION, YAW_RATE_BIAS] = -0.25 * t**3 * left(a_w)
    jacobian[..., POSITION, ACCELERATION_BIAS] = -0.5 * tt**2 * mid_to_world
    jacobian[..., VELOCITY, VELOCITY] = turn
    jacobian[..., VELOCITY, YAW_RATE_BIAS] = t * left(turned_v) + 0.5 * t**2 * left(turned_a)
    jacobian[..., VELOCITY, ACCELERATION_BIAS] = -tt * half_turn
    jacobian[..., HEADING, YAW_RATE_BIAS] = -time

    # Noise of the inputs enters as their biases do, with the opposite sign.
    entry = jacobian[..., :5, 5:8]
    per_second = np.array([parameters.yaw_rate_density, *[parameters.acceleration_density] * 2]) ** 2
    variance = per_second / np.maximum(t, 1e-9)
    noise = np.zeros_like(jacobian)
    noise[..., :5, :5] = (entry * variance[..., None, :]) @ np.swapaxes(entry, -1, -2)
    diagonal = noise[..., range(STATES), range(STATES)]
    diagonal[..., POSITION] += parameters.position_density**2 * t
    diagonal[..., YAW_RATE_BIAS] += parameters.yaw_rate_bias_walk**2 * time
    diagonal[..., ACCELERATION_BIAS] += parameters.acceleration_bias**2 * (1.0 - decay[..., ACCELERATION_BIAS] ** 2)
    diagonal[..., POSITION_BIAS] += parameters.position_bias**2 * (1.0 - decay[..., POSITION_BIAS] ** 2)
    noise[..., range(STATES), range(STATES)] = diagonal
    return Prediction(state=after, jacobian=jacobian, noise=noise)


def fix_model(state: Array, specific_force_b: Array, age: Array) -> tuple[Array, Array]:
    """Returns what a fix of an age should read, and its Jacobian.

    Args:
        state: x, (..., 10).
        specific_force_b: Mean since the fix was true, (..., 2) [m/s^2].
        age: L, (...) [s].

    Returns:
        Position and velocity, (..., 4), and (..., 4, 10).
    """
    to_world = rotation(state[..., HEADING])
    v_w = turned(to_world, state[..., VELOCITY])
    a_w = turned(to_world, specific_force_b - state[..., ACCELERATION_BIAS])
    age, wide = age[..., None], age[..., None, None]
    past_w = state[..., POSITION] + state[..., POSITION_BIAS] - age * v_w + 0.5 * age**2 * a_w
    reading = np.concatenate([past_w, v_w - age * a_w], axis=-1)
    jacobian = np.zeros((*state.shape[:-1], 4, STATES))
    jacobian[..., :2, POSITION] = jacobian[..., :2, POSITION_BIAS] = np.eye(2)
    jacobian[..., :2, VELOCITY] = -wide * to_world
    jacobian[..., 2:, VELOCITY] = to_world
    jacobian[..., :2, HEADING] = -age * left(v_w) + 0.5 * age**2 * left(a_w)
    jacobian[..., 2:, HEADING] = left(v_w) - age * left(a_w)
    jacobian[..., :2, ACCELERATION_BIAS] = -0.5 * wide**2 * to_world
    jacobian[..., 2:, ACCELERATION_BIAS] = wide * to_world
    return reading, jacobian


def turned(matrix: Array, vector: Array) -> Array:
    """Returns matrix times vector, (..., 2)."""
    return (matrix @ vector[..., None])[..., 0]


def left(vector: Array) -> Array:
    """Returns a vector turned to the left by a right angle: the derivative of R(a) u is that of R(a) u, turned."""
    found = np.empty_like(vector)
    found[..., 0], found[..., 1] = -vector[..., 1], vector[..., 0]
    return found
