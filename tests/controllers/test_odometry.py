import math

import numpy as np
import pytest

from dynabot_mj.controllers import axes
from dynabot_mj.controllers.odometry import Odometry, velocity

GAINS = Odometry()
RADIUS, PERIOD = 0.1, 0.036


def step(before, increment, heading, rim_speed):
    """Advances the estimate with all wheels at one rim speed [m/s]."""
    heading = np.array(heading)
    return velocity(
        np.array(before, float),
        np.array(increment, float),
        axes.of_heading(heading),
        np.broadcast_to(np.array(rim_speed)[..., None] / RADIUS, (*heading.shape, 4)),
        wheel_radius=RADIUS,
        period=PERIOD,
        gains=GAINS,
    )


def test_rolling_without_slip_it_is_exact():
    # Two robots on different winding paths, velocity along the heading.
    time = PERIOD * np.arange(400)
    heading = np.stack([np.sin(time), 0.5 * time], axis=-1)
    speed = np.stack([2.0 * np.sin(0.7 * time), 3.0 - time / 5.0], axis=-1)
    truth = speed[:, None] * np.stack([np.cos(heading), np.sin(heading)], axis=1)
    estimate = truth[0]
    for k in range(1, len(time)):
        estimate = step(estimate, truth[k] - truth[k - 1], heading[k], speed[k])
        np.testing.assert_allclose(estimate, truth[k], atol=1e-12)


def test_a_wrong_start_is_forgotten_at_the_rate_of_the_correction():
    estimate = step([2.05, 0.0], [0.0, 0.0], 0.0, 2.0)
    assert estimate[0] - 2.0 == pytest.approx(0.05 * math.exp(-GAINS.correction * PERIOD), rel=0.01)


@pytest.mark.parametrize("heading", [0.0, 2.0])
def test_a_spinning_wheel_hardly_moves_it(heading):
    forward = np.array([math.cos(heading), math.sin(heading)])
    estimate, periods = 1.0 * forward, round(0.5 / PERIOD)
    for _ in range(periods):
        estimate = step(estimate, [0.0, 0.0], heading, 1.0 + 3.0)
    # The wheels count k / (1 + (3 / s)^2); believed, they would have taken it up by 3 (1 - e^(-k t)) m/s.
    drift = estimate @ forward - 1.0
    assert drift == pytest.approx(GAINS.correction / (1.0 + (3.0 / GAINS.slip) ** 2) * 3.0 * 0.5, rel=0.15)
    assert drift < 0.07


def errors_under(bias):
    """Returns the errors of an estimate whose accelerometer is off, at a steady speed with rolling wheels."""
    estimate, errors = np.array([1.5, 0.0]), []
    for _ in range(2000):
        estimate = step(estimate, [bias * PERIOD, 0.0], 0.0, 1.5)
        errors.append(estimate[0] - 1.5)
    return np.array(errors)


@pytest.mark.parametrize("share", [0.1, -0.5, 0.9])
def test_a_biased_accelerometer_errs_by_bias_over_correction(share):
    # The wheels pull by k e / (1 + (e / s)^2), at most k s / 2 where e = s. Below that the error settles where the pull
    # is the bias; in periods, 1 - e^(-k T) takes the place of k T, and the error is that after the correction.
    pull = -math.expm1(-GAINS.correction * PERIOD)
    bias = share * pull / PERIOD * GAINS.slip / 2.0
    ratio = bias * PERIOD / pull
    settled = (1.0 - math.sqrt(1.0 - (2.0 * ratio / GAINS.slip) ** 2)) / (2.0 * ratio) * GAINS.slip**2
    errors = errors_under(bias)
    assert errors[-1] == pytest.approx(settled - bias * PERIOD, rel=1e-3)
    assert np.abs(errors).max() <= abs(settled) <= 2.0 * abs(bias) / GAINS.correction * 1.1
    if abs(share) < 0.2:
        assert errors[-1] == pytest.approx(bias / GAINS.correction, rel=0.05)


def test_a_larger_bias_than_the_wheels_can_hold_runs_away():
    errors = errors_under(1.2 * GAINS.correction * GAINS.slip / 2.0)
    assert errors[-1] > errors[len(errors) // 2] > GAINS.slip


def test_sideways_it_decays_and_the_wheels_say_nothing():
    estimate = np.array([0.0, 1.0])
    for _ in range(50):
        estimate = step(estimate, [0.0, 0.0], 0.0, 0.0)
    np.testing.assert_allclose(estimate, [0.0, math.exp(-GAINS.settling * 50 * PERIOD)], atol=1e-12)


def test_turning_on_the_spot_is_no_speed():
    wheels = np.array([-20.0, 20.0, -20.0, 20.0])
    facing = axes.of_heading(np.array(0.3))
    estimate = velocity(np.zeros(2), np.zeros(2), facing, wheels, wheel_radius=RADIUS, period=PERIOD, gains=GAINS)
    np.testing.assert_array_equal(estimate, 0.0)
