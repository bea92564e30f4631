from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.estimation.estimator import Estimator
from dynabot_mj.perception.estimators import NAMES, build
from dynabot_mj.perception.filters import FilterPerception
from dynabot_mj.plants.plant import FleetState
from dynabot_mj.sensing.faults import Fault
from dynabot_mj.sensing.options import SensorOptions

PERIOD = 0.036
TRIALS = 4
SHAPE = (TRIALS, 2)
ALL = np.ones(SHAPE, dtype=bool)
START = FleetState(
    time=0.0,
    position_w=np.full((*SHAPE, 2), 20.0),
    velocity_w=np.zeros((*SHAPE, 2)),
    heading=np.full(SHAPE, 3.1),
    yaw_rate=np.zeros(SHAPE),
    velocity_increment_b=np.zeros((*SHAPE, 2)),
)


def aligned(name="decoupled", options=None, alignment=4.0, **others):
    return FilterPerception(
        build(name, SHAPE), options or SensorOptions(), PERIOD, 0, range(TRIALS), START, alignment=alignment, **others
    )


@pytest.mark.parametrize("name", NAMES)
def test_after_alignment_robots_know_where_they_are(name):
    perception = aligned(name)
    perception.substep(START)
    belief = perception.observe(START, ALL)
    assert belief.known.all()
    # White noise of 1 m and a slow error of 0.75 m: 1.25 m per axis at most; five deviations.
    assert np.abs(belief.position_w - START.position_w).max() < 6.3
    assert np.abs(belief.velocity_w).max() < 0.7
    # The bearing's errors: iron 6 and 2, motors and noise 2 degrees; the filter averages the last.
    assert np.abs(perception.navigation_error(0.0).heading).max() < np.radians(14.0)


def test_without_a_fix_nothing_is_known():
    perception = aligned(options=SensorOptions(faults=(Fault(kind="outage", start=-10.0, robots=(1,)),)))
    perception.substep(START)
    belief = perception.observe(START, ALL)
    np.testing.assert_array_equal(belief.known, [[True, False]] * TRIALS)
    assert np.isfinite(perception.navigation_error(0.0).heading).all()


def test_the_heading_error_grows_by_the_gyro_that_is_left():
    perception = aligned()
    perception.substep(START)
    perception.observe(START, ALL)
    now, later = perception.navigation_error(0.0), perception.navigation_error(0.5)
    np.testing.assert_allclose(later.heading - now.heading, 0.5 * now.yaw_rate)
    assert np.abs(now.yaw_rate).max() > 0.0


def test_between_samples_the_error_is_what_the_next_sample_shows():
    """Local laws and filter see one and the same sensor: believed heading now = then + period x (gyro - bias)."""
    perception = aligned("decoupled", SensorOptions(faults=(Fault(kind="nan", channel="magnetometer", start=0.0),)))
    perception.substep(START)
    perception.observe(START, ALL)
    expected = perception.navigation_error(PERIOD).heading
    state = replace(START, time=PERIOD)
    perception.substep(state)
    perception.observe(state, ALL)  # without a bearing, the filter only carries its heading on
    np.testing.assert_allclose(perception.navigation_error(PERIOD).heading, expected, atol=1e-12)


def test_a_slope_is_felt_during_alignment():
    level, uphill = (
        aligned("coupled", alignment=30.0, uphill=rise).navigation_error(0.0).acceleration_b for rise in (0.0, 0.02)
    )
    # The filter takes the 0.2 m/s^2 for a bias of the accelerometer, along the robot's axes, and finds part of it.
    found = (level - uphill)[..., 0] * np.cos(START.heading) - (level - uphill)[..., 1] * np.sin(START.heading)
    assert (found > 0.05).all()


def test_what_is_wrong_with_the_gyro_is_wrong_for_the_local_laws_too():
    """A gyro that is stuck at rest says zero while the robot turns: the laws' rate is off by the robot's own."""
    stuck = SensorOptions(faults=(Fault(kind="frozen", channel="gyro", start=-PERIOD),))
    for options, expected in ((stuck, -0.5), (SensorOptions(), 0.0)):
        perception = aligned("gps", options)
        for step in range(3):
            now = PERIOD * step
            state = replace(START, time=now, heading=START.heading + 0.5 * now, yaw_rate=START.yaw_rate + 0.5)
            perception.substep(state)
            perception.observe(state, ALL)
        # White noise of 0.5 and a bias of 0.5 deg/s, of which the filter has found a part: five deviations of both.
        np.testing.assert_allclose(perception.navigation_error(now).yaw_rate, expected, atol=np.radians(3.6))


def test_a_fix_that_is_true_just_before_the_start_is_not_missed():
    """Samples at -0.156 s and 0, fixes without latency every 0.1 s: the one of -0.056 s is there at the start."""
    gps = replace(SensorOptions().gps, period=0.1, latency=0.0, stamp_error=0.0)
    period, received = 0.156, []

    class Spy(Estimator):
        def step(self, imu, fix, due):
            received.append(fix.received.all() and fix.age.max())
            return super().step(imu, fix, due)

    estimator = Spy(build("coupled", SHAPE).filter, SHAPE)
    perception = FilterPerception(
        estimator, replace(SensorOptions(), gps=gps), period, 0, range(TRIALS), START, alignment=period
    )
    perception.substep(START)
    perception.observe(START, ALL)
    assert received == pytest.approx([0.0, 0.056])
