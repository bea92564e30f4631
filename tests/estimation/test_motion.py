from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from dynabot_mj.estimation import motion
from dynabot_mj.estimation.measurements import ImuSample, rotation
from dynabot_mj.estimation.parameters import DEFAULT, Parameters

STEP = 1e-4  # of central differences: their error is below 1e-7 on these ranges
# X, Y, v_x, v_y, phi, b_r, b_ax, b_ay, b_x, b_y
LARGEST = np.array([50.0, 50.0, 8.0, 3.0, 4.0, 0.05, 0.5, 0.5, 3.0, 3.0])

states = hnp.arrays(np.float64, 10, elements=st.floats(-1.0, 1.0)).map(lambda share: share * LARGEST)
imus = st.builds(
    lambda period, ahead, left, yaw_rate: imu(period, (ahead, left), yaw_rate),
    st.floats(0.0, 0.3),
    st.floats(-8.0, 8.0),
    st.floats(-8.0, 8.0),
    st.floats(-4.0, 4.0),
)


def imu(period, force_b=(0.0, 0.0), yaw_rate=0.0):
    return ImuSample(
        period=np.array(period),
        specific_force_b=np.array(force_b),
        yaw_rate=np.array(yaw_rate),
        magnetic_heading=np.array(0.0),
    )


def derivative(function, at):
    columns = [(function(at + one) - function(at - one)) / (2.0 * STEP) for one in STEP * np.eye(len(at))]
    return np.stack(columns, axis=-1)


def after(state, sample):
    return motion.predict(state, sample, DEFAULT).state


@given(states, imus)
def test_jacobian_of_the_motion(state, sample):
    expected = derivative(lambda x: after(x, sample), state)
    np.testing.assert_allclose(motion.predict(state, sample, DEFAULT).jacobian, expected, atol=1e-6)


@given(states, imus, st.floats(0.0, 0.4))
def test_jacobian_of_the_fix(state, sample, age):
    force_b, age = sample.specific_force_b, np.array(age)
    expected = derivative(lambda x: motion.fix_model(x, force_b, age)[0], state)
    np.testing.assert_allclose(motion.fix_model(state, force_b, age)[1], expected, atol=1e-6)


@given(states, imus.filter(lambda sample: sample.period > 1e-3))
def test_noise_of_the_inputs_moves_the_state_as_the_inputs_do(state, sample):
    def moved(inputs):
        return after(state, replace(sample, yaw_rate=inputs[0], specific_force_b=inputs[1:]))[:5]

    by_inputs = derivative(moved, np.array([sample.yaw_rate, *sample.specific_force_b]))
    densities = np.array([DEFAULT.yaw_rate_density, DEFAULT.acceleration_density, DEFAULT.acceleration_density])
    expected = by_inputs @ np.diag(densities**2 / sample.period) @ by_inputs.T
    expected += np.diag([1.0, 1.0, 0.0, 0.0, 0.0]) * DEFAULT.position_density**2 * sample.period
    noise = motion.predict(state, sample, DEFAULT).noise
    np.testing.assert_allclose(noise[:5, :5], expected, atol=1e-7)
    np.testing.assert_array_equal(noise[:5, 5:], 0.0)
    np.testing.assert_array_equal(noise[5:, :5], 0.0)


def test_biases_keep_their_deviations():
    parameters = Parameters(
        acceleration_bias=0.3, acceleration_bias_time=2.0, position_bias=4.0, position_bias_time=5.0
    )
    prediction = motion.predict(np.zeros(10), imu(0.7), parameters)
    stationary = np.diag([0.3**2, 0.3**2, 4.0**2, 4.0**2])
    decay, noise = prediction.jacobian[6:, 6:], prediction.noise[6:, 6:]
    np.testing.assert_allclose(decay @ stationary @ decay.T + noise, stationary, rtol=1e-12)
    assert prediction.jacobian[5, 5] == 1.0  # that of the gyro walks
    assert prediction.noise[5, 5] == pytest.approx(parameters.yaw_rate_bias_walk**2 * 0.7)


@given(states, imus)
def test_motion_under_constant_acceleration_along_the_mean_heading(state, sample):
    found, time = after(state, sample), sample.period
    yaw_rate = sample.yaw_rate - state[5]
    acceleration_w = rotation(state[4] + 0.5 * yaw_rate * time) @ (sample.specific_force_b - state[6:8])
    velocity_w = rotation(state[4]) @ state[2:4]
    np.testing.assert_allclose(found[:2], state[:2] + time * velocity_w + 0.5 * time**2 * acceleration_w, atol=1e-12)
    np.testing.assert_allclose(rotation(found[4]) @ found[2:4], velocity_w + time * acceleration_w, atol=1e-12)
    np.testing.assert_allclose(found[4], state[4] + time * yaw_rate, atol=1e-12)


def test_straight_line():
    state = np.zeros(10)
    state[motion.HEADING], state[motion.VELOCITY] = np.pi / 2, [2.0, 0.0]
    found = after(state, imu(0.5, force_b=(1.0, 0.0)))
    np.testing.assert_allclose(found[:5], [0.0, 1.125, 2.5, 0.0, np.pi / 2], atol=1e-15)


def test_half_a_circle_at_the_longest_period_of_table_iii():
    speed, radius, steps = 3.0, 7.0, 47
    yaw_rate = speed / radius
    period = np.pi / yaw_rate / steps  # 156 ms
    state = np.zeros(10)
    state[2] = speed
    for _ in range(steps):
        state = after(state, imu(period, force_b=(0.0, speed * yaw_rate), yaw_rate=yaw_rate))
    # Euler's rule is half a metre off.
    np.testing.assert_allclose(state[:5], [0.0, 2.0 * radius, speed, 0.0, np.pi], atol=0.01)


@given(states, st.floats(-8.0, 8.0), st.floats(-4.0, 4.0))
def test_no_time_changes_nothing(state, force, yaw_rate):
    prediction = motion.predict(state, imu(0.0, force_b=(force, force), yaw_rate=yaw_rate), DEFAULT)
    np.testing.assert_array_equal(prediction.state, state)
    np.testing.assert_array_equal(prediction.jacobian, np.eye(10))
    np.testing.assert_array_equal(prediction.noise, 0.0)


@given(states, st.floats(0.0, 0.4), st.floats(-8.0, 8.0), st.floats(-8.0, 8.0))
def test_a_fix_sees_the_past(state, age, ahead, left):
    state[5:] = 0.0  # biases decay meanwhile; the heading stays
    now = after(state, imu(age, force_b=(ahead, left)))
    now[motion.POSITION_BIAS] = [1.5, -0.5]
    reading, _ = motion.fix_model(now, np.array([ahead, left]), np.array(age))
    np.testing.assert_allclose(reading[:2], state[:2] + now[motion.POSITION_BIAS], atol=1e-12)
    np.testing.assert_allclose(reading[2:], rotation(state[4]) @ state[2:4], atol=1e-12)


def test_leading_axes_are_independent():
    rng = np.random.default_rng(1)
    state = rng.standard_normal((2, 3, 10))
    sample = ImuSample(
        period=rng.uniform(0.0, 0.2, (2, 3)),
        specific_force_b=rng.standard_normal((2, 3, 2)),
        yaw_rate=rng.standard_normal((2, 3)),
        magnetic_heading=np.zeros((2, 3)),
    )
    together = motion.predict(state, sample, DEFAULT)
    one = imu(sample.period[1, 2], sample.specific_force_b[1, 2], sample.yaw_rate[1, 2])
    alone = motion.predict(state[1, 2], one, DEFAULT)
    for name in ("state", "jacobian", "noise"):
        np.testing.assert_allclose(getattr(together, name)[1, 2], getattr(alone, name), atol=1e-14)


def test_left_is_the_derivative_of_a_turn():
    np.testing.assert_array_equal(motion.left(np.array([[3.0, 1.0]])), [[-1.0, 3.0]])
