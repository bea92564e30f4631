import dataclasses
import math

import numpy as np
import pytest

from dynabot_mj.experiments.estimators import kinematic
from dynabot_mj.perception import estimators
from dynabot_mj.sensing import replay
from dynabot_mj.sensing.faults import Fault
from dynabot_mj.sensing.options import SensorOptions

PERIOD, STEPS = 0.036, 2100

FAULTS = (
    Fault(kind="outage", start=20.0, end=26.0),
    Fault(kind="nan", channel="accelerometer", start=30.0, end=30.5),
    Fault(kind="nan", channel="magnetometer", start=33.0, end=35.0),
    Fault(kind="nan", channel="gyro", start=36.0, end=36.3),
    Fault(kind="nan", channel="gps_velocity", start=37.0, end=37.9),
    Fault(kind="jump", start=40.0, end=46.0, size=15.0),  # longer than the patience
    Fault(kind="nan", channel="gps_position", start=50.0, end=50.7),
    Fault(kind="magnetic", start=55.0, end=60.0, size=math.radians(170.0)),  # longer than the patience, too
    Fault(kind="dropped", channel="magnetometer", start=62.0, end=70.0, size=0.3),
)

TWINS = [name for name in estimators.NAMES if estimators.has_twin(name)]


@pytest.fixture(scope="module")
def samples():
    """A drive round and round in circles, with all that can go wrong."""
    truth = kinematic.follow("circle", 1, 3, STEPS * PERIOD, PERIOD)
    return replay.record(truth, SensorOptions(faults=FAULTS), PERIOD, 3)


def test_the_stream_has_what_twins_may_differ_in(samples):
    bearing = samples.imu.magnetic_heading[:, 0]
    assert len(samples.time) > STEPS
    assert (np.abs(np.diff(bearing[np.isfinite(bearing)])) > 6.0).sum() >= 5  # wraps
    for values in (samples.imu.magnetic_heading, samples.imu.yaw_rate, samples.imu.specific_force_b):
        assert np.isnan(values).any()
    for values in (samples.fix.position_w, samples.fix.velocity_w):
        assert np.isnan(values[samples.fix.received]).any()
    assert np.diff(samples.time[samples.fix.received[:, 0]]).max() > 5.0  # gap


@pytest.mark.parametrize("name", TWINS)
def test_twins_agree(name, samples):
    batched, twin = (estimators.build(name, (1,), implementation=one) for one in estimators.IMPLEMENTATIONS)
    believed = []

    def biases(estimator):
        found, beliefs = [], estimator.filter.beliefs
        believed.append(found)

        def watch(index):
            values = beliefs()
            found.append(np.concatenate([values["yaw_rate_bias"], values["acceleration_bias_b"][0]]))

        return watch

    expected = replay.follow(samples, batched, biases(batched))
    found = replay.follow(samples, twin, biases(twin))
    for field in dataclasses.fields(replay.Track):
        a, b = getattr(found, field.name), getattr(expected, field.name)
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-9, err_msg=field.name)
    np.testing.assert_allclose(believed[1], believed[0], atol=1e-9)
    assert expected.fix_age[expected.known].max() > 3.0  # something has been rejected or missing


@pytest.mark.parametrize("name", ["decoupled", "coupled"])
def test_twins_agree_on_all_moments_and_updates(name, wild):
    batched, twin = (estimators.build(name, (3,), implementation=one) for one in estimators.IMPLEMENTATIONS)
    rng = np.random.default_rng(0)
    for imu, fix in wild(150, robots=3):
        due = rng.random(3) < 0.7  # so that rows are mixed
        for estimator in (batched, twin):
            estimator.step(imu, fix, due)
        for a, b in zip(twin.filter.moments(), batched.filter.moments(), strict=True):
            np.testing.assert_allclose(a, b, atol=1e-9)
        (rows, found), (expected_rows, expected) = twin.fix_updates, batched.fix_updates
        np.testing.assert_array_equal(rows, expected_rows)
        for one, other in zip(found, expected, strict=True):
            for field in ("innovation", "innovation_covariance", "squared", "accepted"):
                np.testing.assert_allclose(getattr(one, field), getattr(other, field), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", TWINS)
def test_missing_bearings_leave_no_trace(name, straight):
    """FilterPy's filters take a NaN, and keep healthy covariances with it."""
    estimator = estimators.build(name, (1,), implementation="filterpy")
    for imu, fix in straight(10):
        estimator.step(imu, fix, np.ones(1, dtype=bool))
    before = estimator.filter.beliefs()
    update = estimator.filter.see_heading(slice(None), np.array([np.nan]))
    assert not update.accepted[0]
    assert np.isnan(update.squared[0])
    for key, value in estimator.filter.beliefs().items():
        np.testing.assert_array_equal(value, before[key])


@pytest.mark.parametrize("name", TWINS)
def test_broken_numbers_are_not_sound(name, straight):
    estimator = estimators.build(name, (2,), implementation="filterpy")
    for imu, fix in straight(10, robots=2):
        estimator.step(imu, fix, np.ones(2, dtype=bool))
    assert estimator.filter.sound().all()
    bad, _ = straight(1, robots=2)[0]
    bad.period[1] = np.nan
    estimator.filter.predict(slice(None), bad)
    np.testing.assert_array_equal(estimator.filter.sound(), [True, False])
