import numpy as np
import pytest

from dynabot_mj.experiments.estimators import kinematic
from dynabot_mj.perception import estimators
from dynabot_mj.sensing import replay
from dynabot_mj.sensing.options import SensorOptions

PERIOD = 0.036


def recorded(runs, first=0):
    truth = kinematic.follow("circle", runs, 3, 6.0, PERIOD / 3.0, first)
    return replay.record(truth, SensorOptions(), PERIOD, 3, first)


@pytest.fixture(scope="module")
def record():
    return recorded(2)


def test_a_record_has_a_sample_at_every_period_from_the_start_on(record):
    np.testing.assert_allclose(record.time, PERIOD * np.arange(len(record.time)), atol=1e-9)
    assert record.time[-1] == pytest.approx(6.0, abs=PERIOD)
    np.testing.assert_array_equal(record.imu.period[0], 0.0)  # no average over a time that has not passed
    np.testing.assert_allclose(record.imu.period[1:], PERIOD)
    # Fixes are true every 0.2 s from the start on, and 0.15 s on their way: those up to 5.8 s have arrived.
    assert record.fix.received.sum(axis=0).tolist() == [30, 30]
    # At rest the gyro says nothing but its slow error, which is on record, and white noise, whose mean over 3.6 s has a
    # deviation of its density / sqrt(3.6 s): 4.5 of them.
    rest = slice(1, 101)
    noise = (record.imu.yaw_rate[rest] - record.errors[rest, :, 0]).mean(axis=0)
    np.testing.assert_allclose(noise, 0.0, atol=4.5 * SensorOptions().imu.yaw_rate_density / np.sqrt(3.6))


def test_a_run_has_the_samples_of_its_number(record):
    alone = recorded(1, first=1)
    for name in ("specific_force_b", "yaw_rate", "magnetic_heading"):
        np.testing.assert_array_equal(getattr(alone.imu, name)[:, 0], getattr(record.imu, name)[:, 1], err_msg=name)
    np.testing.assert_array_equal(alone.fix.position_w[:, 0], record.fix.position_w[:, 1])


def test_an_estimator_is_given_every_sample_once_and_in_order(record):
    seen, estimator = [], estimators.build("gps", (2,))
    track = replay.follow(record, estimator, seen.append)
    assert seen == list(range(len(record.time)))
    # Nothing is known before the first fix has come, and what is believed last is what the estimator believes.
    first = record.fix.received.argmax(axis=0)
    np.testing.assert_array_equal(track.known.argmax(axis=0), first)
    assert not track.known[: first.min()].any()
    np.testing.assert_array_equal(track.position_w[-1], estimator.filter.beliefs()["position_w"])
    np.testing.assert_array_equal(track.restarts, 0)
