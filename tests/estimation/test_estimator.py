from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.estimation.estimator import Estimator
from dynabot_mj.estimation.kalman import Update
from dynabot_mj.estimation.measurements import ImuSample, wrap
from dynabot_mj.estimation.parameters import DEFAULT
from dynabot_mj.perception import estimators

EKFS = ("decoupled", "coupled")
BELIEFS = ("position_w", "velocity_w", "heading", "yaw_rate_bias", "acceleration_bias_b")
PERIOD, FIX_EVERY, LATENCY = 0.05, 4, 0.1  # of the drives in conftest
AHEAD = 3.0 * np.array([np.cos(0.3), np.sin(0.3)])  # their velocity [m/s]
JUMP = np.array([15.0, 0.0])  # [m]


@pytest.fixture(params=estimators.NAMES)
def name(request):
    return request.param


def run(estimator, samples, due=None):
    return [
        estimator.step(imu, fix, np.ones(fix.age.shape, dtype=bool) if due is None else due) for imu, fix in samples
    ]


def off(estimates, start=0):
    """Distances from the truth of the straight drive."""
    truth = PERIOD * (start + np.arange(len(estimates)))[:, None] * AHEAD
    return np.linalg.norm(np.stack([one.position_w[0] for one in estimates]) - truth, axis=-1)


def changed(samples, first, last, **values):
    """Changes arrays of the samples with these indices: by a value, or by a function of what they were."""

    def value(old, make):
        return make(old) if callable(make) else np.full_like(old, make)

    def new(part):
        own = values.keys() & vars(part).keys()
        return replace(part, **{key: value(getattr(part, key), values[key]) for key in own})

    return [(new(imu), new(fix)) if first <= index < last else (imu, fix) for index, (imu, fix) in enumerate(samples)]


def same(a, b, rows):
    for field in (*BELIEFS, "position_covariance", "velocity_covariance_b", "heading_variance", "fix_age"):
        np.testing.assert_array_equal(getattr(a, field)[rows], getattr(b, field)[rows], err_msg=field)


def poison(estimator, row):
    filter_ = estimator.filter
    for part in (filter_, getattr(filter_, "heading", None), getattr(filter_, "_heading", None)):
        if hasattr(part, "covariance"):
            part.covariance[row] = np.nan


# Starting


def test_it_starts_at_the_first_fix_with_a_bearing(name, straight):
    samples = changed(straight(14), 0, 4, received=False)
    samples = changed(samples, 4, 8, magnetic_heading=np.nan)
    samples = changed(samples, 8, 12, position_w=np.nan)
    estimates = run(estimators.build(name, (1,)), samples)
    assert [bool(one.known[0]) for one in estimates] == [False] * 12 + [True] * 2
    assert np.isinf(estimates[11].fix_age[0])
    np.testing.assert_allclose(off(estimates[12:], start=12), 0.0, atol=1e-9)
    np.testing.assert_allclose(estimates[12].velocity_w[0], AHEAD, atol=1e-9)
    assert estimates[12].heading[0] == pytest.approx(0.3)


def test_samples_without_errors_leave_no_error(name, straight):
    np.testing.assert_allclose(off(run(estimators.build(name, (1,)), straight(200))), 0.0, atol=1e-9)


# Missing samples


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize(
    "channel", ["specific_force_b", "yaw_rate", "magnetic_heading", "position_w", "velocity_w", "age"]
)
def test_what_is_not_finite_never_reaches_a_state(name, straight, channel, value):
    samples = changed(straight(60), 21, 45, **{channel: value})
    estimates = run(estimators.build(name, (1,)), samples)
    for one in estimates:
        for field in (*BELIEFS, "position_covariance", "velocity_covariance_b", "heading_variance", "fix_age"):
            assert np.isfinite(getattr(one, field)).all()
    assert estimates[-1].restarts[0] == 0
    np.testing.assert_allclose(off(estimates), 0.0, atol=1e-9)


@pytest.mark.parametrize("channel", ["specific_force_b", "yaw_rate"])
def test_the_last_good_sample_stands_for_a_missing_one(name, straight, channel):
    turning = changed(straight(40), 10, 30, **{channel: 0.5})
    expected = run(estimators.build(name, (1,)), turning)
    found = run(estimators.build(name, (1,)), changed(turning, 15, 25, **{channel: np.nan}))
    same(found[-1], expected[-1], slice(None))


# Belief


@pytest.mark.parametrize("name", EKFS)
def test_a_jump_of_two_seconds_is_rejected(name, straight):
    jump = changed(straight(160), 60, 100, position_w=lambda position: position + JUMP)
    estimates = run(estimators.build(name, (1,)), jump)
    np.testing.assert_allclose(off(estimates), 0.0, atol=1e-6)
    ages = np.array([one.fix_age[0] for one in estimates])
    assert ages[99] == pytest.approx(LATENCY + 43 * PERIOD)  # the last believed fix came with sample 56
    assert ages[100] == pytest.approx(LATENCY)
    assert estimates[99].stale[0]
    assert not estimates[100].stale[0]


@pytest.mark.parametrize("name", EKFS)
def test_a_jump_that_stays_is_believed_after_the_patience(name, straight):
    jump = changed(straight(160), 60, 160, position_w=lambda position: position + JUMP)
    errors = off(run(estimators.build(name, (1,)), jump))
    rejected = 60 + round(DEFAULT.fix_patience / PERIOD)  # from sample 60 on
    np.testing.assert_allclose(errors[: rejected + 1], 0.0, atol=1e-6)
    believed = rejected + FIX_EVERY
    np.testing.assert_allclose(errors[believed:], 15.0, atol=1e-6)


def test_gps_extrapolation_believes_every_jump(straight):
    jump = changed(straight(100), 60, 100, position_w=lambda position: position + JUMP)
    errors = off(run(estimators.build("gps", (1,)), jump))
    np.testing.assert_allclose(errors[:60], 0.0, atol=1e-9)
    np.testing.assert_allclose(errors[60:], 15.0, atol=1e-9)


def test_a_wrong_first_bearing_is_corrected_and_the_velocity_over_ground_goes_on(name, straight):
    wrong = changed(straight(80), 0, 1, magnetic_heading=lambda bearing: wrap(bearing + np.radians(170.0)))
    estimates = run(estimators.build(name, (1,)), wrong)
    heading_errors = np.abs(wrap(np.array([one.heading[0] for one in estimates]) - 0.3))
    rejected = 1 + round(DEFAULT.bearing_patience / PERIOD)  # from sample 1 on
    assert (heading_errors[:rejected] > np.radians(169.0)).all()
    assert (heading_errors[rejected + 1 :] < np.radians(1.0)).all()
    velocity_w = np.stack([one.velocity_w[0] for one in estimates])
    np.testing.assert_allclose(velocity_w, np.tile(AHEAD, (80, 1)), atol=1e-6)


def test_a_good_sample_ends_the_doubt(straight):
    """Rejections count from the last sample that was believed, however many there have been."""
    samples = straight(300)
    for start in (60, 120, 180):
        samples = changed(samples, start, start + 56, position_w=lambda position: position + JUMP)
    np.testing.assert_allclose(off(run(estimators.build("coupled", (1,)), samples)), 0.0, atol=1e-6)


def test_age_of_the_fix_and_staleness(name, straight):
    estimates = run(estimators.build(name, (1,)), changed(straight(41), 21, 40, received=False))
    ages = np.array([one.fix_age[0] for one in estimates])
    np.testing.assert_allclose(ages[:8], LATENCY + PERIOD * np.array([0, 1, 2, 3, 0, 1, 2, 3]))
    np.testing.assert_allclose(ages[20:40], LATENCY + PERIOD * np.arange(20))
    stale = [bool(one.stale[0]) for one in estimates]
    assert not any(stale[:28])
    assert all(stale[29:40])  # at sample 28 it is half a second
    assert not stale[40]


# Breaking down


def test_broken_numbers_restart_at_the_next_fix_and_nobody_else(name, straight):
    samples = straight(60, robots=3)
    healthy, broken = estimators.build(name, (3,)), estimators.build(name, (3,))
    run(healthy, samples[:30])
    run(broken, samples[:30])
    poison(broken, 1)
    expected, found = run(healthy, samples[30:]), run(broken, samples[30:])
    assert [bool(one.known[1]) for one in found[:3]] == [False, False, True]  # a fix comes with sample 32
    assert np.isinf(found[0].fix_age[1])
    np.testing.assert_array_equal(found[-1].restarts, [0, 1, 0])
    np.testing.assert_allclose(found[-1].position_w[1], expected[-1].position_w[1], atol=1e-9)
    same(found[-1], expected[-1], [0, 2])


# Many robots


def test_robots_that_are_not_due_stay_as_they_are(name, wild):
    samples, estimator = wild(60, robots=3), estimators.build(name, (3,))
    before = run(estimator, samples[:40])[-1]
    after = run(estimator, samples[40:], due=np.array([True, False, True]))[-1]
    same(after, before, 1)
    assert (after.heading[[0, 2]] != before.heading[[0, 2]]).all()


def test_a_robot_does_not_depend_on_the_others(name, wild):
    """Alone, among others, and where some are not due: rows are views in one case, copies in another."""
    samples = wild(120, robots=3)

    def of(part, rows):
        return replace(part, **{key: values[rows] for key, values in vars(part).items()})

    alone = run(estimators.build(name, (1,)), [(of(imu, [1]), of(fix, [1])) for imu, fix in samples])[-1]
    together = run(estimators.build(name, (3,)), samples)[-1]
    partly = run(estimators.build(name, (3,)), samples, due=np.array([False, True, True]))[-1]
    for field in (*BELIEFS, "position_covariance", "velocity_covariance_b", "heading_variance"):
        expected = getattr(alone, field)[0]
        np.testing.assert_allclose(getattr(together, field)[1], expected, rtol=1e-12, atol=1e-13, err_msg=field)
        np.testing.assert_allclose(getattr(partly, field)[1], expected, rtol=1e-12, atol=1e-13, err_msg=field)


def test_leading_axes_are_only_an_arrangement(name, wild):
    samples = wild(30, robots=6)

    def arranged(part):
        return replace(part, **{key: values.reshape(2, 3, *values.shape[1:]) for key, values in vars(part).items()})

    flat = run(estimators.build(name, (6,)), samples)[-1]
    found = run(estimators.build(name, (2, 3)), [(arranged(imu), arranged(fix)) for imu, fix in samples])[-1]
    assert found.position_covariance.shape == (2, 3, 2, 2)
    for field in BELIEFS:
        np.testing.assert_array_equal(getattr(found, field)[1, 2], getattr(flat, field)[5])


# What a filter is given


class Spy:
    """A filter that believes everything and keeps what it is given."""

    def __init__(self):
        self.forces = []

    def begin(self, rows, fix, magnetic_heading):
        pass

    def predict(self, rows, imu):
        pass

    def see_heading(self, rows, magnetic_heading):
        return self._update(magnetic_heading)

    def see_fix(self, rows, fix, force_b):
        self.forces.append(force_b)
        return (self._update(fix.age),)

    def sound(self):
        return np.ones(1, dtype=bool)

    def beliefs(self):
        zero, matrix = np.zeros((1, 2)), np.zeros((1, 2, 2))
        return {
            "position_w": zero,
            "velocity_w": zero,
            "heading": np.zeros(1),
            "yaw_rate_bias": np.zeros(1),
            "acceleration_bias_b": zero,
            "position_covariance": matrix,
            "velocity_covariance_b": matrix,
            "heading_variance": np.zeros(1),
        }

    def _update(self, like):
        number = np.zeros(len(like))
        return Update(
            state=number,
            covariance=number,
            innovation=number,
            innovation_covariance=number,
            squared=number,
            accepted=np.ones(len(like), dtype=bool),
        )


@pytest.mark.parametrize(("age", "mean"), [(0.05, 4.0), (0.075, (4.0 * 0.05 + 3.0 * 0.025) / 0.075), (0.2, 2.5)])
def test_a_fix_is_reached_back_to_with_the_mean_force_since(straight, age, mean):
    spy, samples = Spy(), straight(5)
    for index in range(5):
        samples = changed(samples, index, index + 1, specific_force_b=float(index), age=age)
    run(Estimator(spy, (1,)), samples)
    np.testing.assert_allclose(spy.forces[-1], [[mean, mean]], rtol=1e-6)


def test_the_latest_updates_are_those_of_the_latest_step(straight):
    estimator, samples = estimators.build("coupled", (2,)), straight(6, robots=2)
    run(estimator, samples[:5])
    rows, updates = estimator.fix_updates
    assert list(rows) == [0, 1]
    assert updates[0].squared.shape == (2,)
    estimator.step(*samples[4], np.zeros(2, dtype=bool))
    assert estimator.fix_updates[0].size == 0


def test_a_sample_of_a_robot_that_is_not_due_is_not_looked_at(straight):
    estimator, samples = estimators.build("coupled", (2,)), straight(10, robots=2)
    run(estimator, samples)
    imu, fix = samples[-1]
    nothing = np.array([0.0, np.nan])
    bad = ImuSample(
        period=imu.period + nothing,
        specific_force_b=imu.specific_force_b + nothing[:, None],
        yaw_rate=imu.yaw_rate + nothing,
        magnetic_heading=imu.magnetic_heading + nothing,
    )
    found = estimator.step(bad, fix, np.array([True, False]))
    assert np.isfinite(found.position_w).all()
    assert np.isfinite(found.fix_age).all()
