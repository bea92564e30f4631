import numpy as np
import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.sensing import faults as sensor_faults
from dynabot_mj.sensing.faults import Fault, Faults

DROPPED = {"kind": "dropped", "channel": "gyro"}
FIX = np.arange(12.0).reshape(2, 3, 2)


def faults(*given):
    return Faults(given, 0, range(2), 3)


def test_nothing_happens_outside_of_the_window():
    acting = faults(
        Fault(kind="outage", start=1.0, end=2.0),
        Fault(kind="jump", size=15.0, start=1.0, end=2.0),
        Fault(kind="nan", channel="gyro", start=1.0, end=2.0),
        Fault(kind="magnetic", size=1.0, start=1.0, end=2.0),
    )
    for time in (0.99, 2.0):
        position, velocity, received = acting.fixes(FIX, FIX, time)
        np.testing.assert_array_equal(position, FIX)
        np.testing.assert_array_equal(velocity, FIX)
        assert received.all()
        np.testing.assert_array_equal(acting.samples("gyro", FIX[..., 0], time), FIX[..., 0])
        np.testing.assert_array_equal(acting.samples("magnetometer", FIX[..., 0], time), FIX[..., 0])


def test_an_outage_takes_the_fixes_of_its_robots():
    *_, received = faults(Fault(kind="outage", robots=(0, 2))).fixes(FIX, FIX, 0.0)
    np.testing.assert_array_equal(received, [[False, True, False]] * 2)


def test_a_jump_moves_positions_toward_x():
    position, velocity, _ = faults(Fault(kind="jump", size=15.0)).fixes(FIX, FIX, 0.0)
    np.testing.assert_array_equal(position - FIX, np.broadcast_to([15.0, 0.0], FIX.shape))
    np.testing.assert_array_equal(velocity, FIX)


@pytest.mark.parametrize("channel", ["accelerometer", "gyro", "magnetometer"])
def test_nan_is_of_one_channel(channel):
    acting = faults(Fault(kind="nan", channel=channel, robots=(1,)))
    for other in ("accelerometer", "gyro", "magnetometer"):
        broken = np.isnan(acting.samples(other, FIX, 0.0)).any(axis=(0, 2))
        np.testing.assert_array_equal(broken, [False, other == channel, False])


def test_a_frozen_channel_repeats_what_it_said_before():
    acting = faults(Fault(kind="frozen", channel="gyro", start=1.0, end=3.0, robots=(2,)))
    said = [acting.samples("gyro", np.full((2, 3), float(time)), float(time)) for time in range(5)]
    assert [one[0, 2] for one in said] == [0.0, 0.0, 0.0, 3.0, 4.0]
    assert [one[0, 0] for one in said] == [0.0, 1.0, 2.0, 3.0, 4.0]


def test_dropped_samples_are_missing_at_random():
    acting = faults(Fault(kind="dropped", channel="gps_position", size=0.3))
    lost = np.mean([np.isnan(acting.fixes(FIX, FIX, 0.0)[0]).any(axis=-1) for _ in range(2000)])
    # 12,000 independent draws: 4.5 standard deviations of their mean.
    assert lost == pytest.approx(0.3, abs=4.5 * np.sqrt(0.3 * 0.7 / 12000))


def test_a_magnetic_fault_turns_the_bearing():
    turned = faults(Fault(kind="magnetic", size=0.5)).samples("magnetometer", FIX[..., 0], 0.0)
    np.testing.assert_array_equal(turned, FIX[..., 0] + 0.5)


def test_faults_with_what_their_kind_needs_are_allowed():
    sensor_faults.check([Fault(kind="outage"), Fault(kind="jump", size=-3.0, robots=(0, 2))], 3)
    sensor_faults.check([Fault(**DROPPED, size=1.0), Fault(kind="frozen", channel="accelerometer")], 3)


@pytest.mark.parametrize(
    ("fault", "told"),
    [
        ({"kind": "outage", "start": 2.0, "end": 1.0}, "a fault from 2 to 1 s given, it never acts"),
        ({"kind": "outage", "robots": (0, 3)}, "robot 3 given, there are the robots 0 to 2"),
        ({"kind": "outage", "channel": "gyro"}, "channel = gyro given with outage, which needs none"),
        ({"kind": "outage", "size": 1.0}, "size = 1.0 given with outage, which needs none"),
        ({"kind": "jump"}, "no size given with jump, which needs one"),
        ({"kind": "jump", "size": 0.0}, "not 0"),
        ({"kind": "jump", "size": float("inf")}, "not 0, and at most"),
        ({"kind": "frozen"}, "no channel given with frozen"),
        ({**DROPPED, "size": 7.0}, "above 0 and at most 1"),
    ],
)
def test_faults_that_mean_nothing_are_refused(fault, told):
    with pytest.raises(InputError, match=told):
        sensor_faults.check([Fault(**fault)], 3)
