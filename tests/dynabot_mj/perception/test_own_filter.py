import numpy as np
import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.estimation.estimator import Estimator
from dynabot_mj.estimation.gps_extrapolation import GpsExtrapolation
from dynabot_mj.estimation.measurements import GpsFix, ImuSample
from dynabot_mj.estimation.parameters import DEFAULT
from dynabot_mj.perception.own_filter import CheckedFilter

SHAPE = (2, 3)


def made(changes=None):
    """A filter of ours as if it were the user's, with some methods changed."""
    kind = type("Mine", (GpsExtrapolation,), changes or {})
    return Estimator(CheckedFilter("mine", kind(6, DEFAULT), 6), SHAPE)


def steps(estimator, count=3):
    """Runs it over samples of robots that go to the left at 1 m/s, and returns the last estimate."""
    due = np.ones(SHAPE, dtype=bool)
    for step in range(count):
        fix = GpsFix(
            received=due,
            position_w=np.full((*SHAPE, 2), [0.0, 0.2 * step]),
            velocity_w=np.full((*SHAPE, 2), [0.0, 1.0]),
            age=np.full(SHAPE, 0.1),
        )
        imu = ImuSample(
            period=np.full(SHAPE, 0.2),
            specific_force_b=np.zeros((*SHAPE, 2)),
            yaw_rate=np.zeros(SHAPE),
            magnetic_heading=np.full(SHAPE, 0.5 * np.pi),
        )
        found = estimator.step(imu, fix, due)
    return found


def test_a_filter_that_is_sound_gives_what_it_gives_unchecked():
    checked, plain = steps(made()), steps(Estimator(GpsExtrapolation(6, DEFAULT), SHAPE))
    for name, value in vars(plain).items():
        np.testing.assert_array_equal(getattr(checked, name), value)


def test_a_belief_stays_although_the_filter_goes_on_with_its_array():
    kept = np.zeros((6, 2))

    def beliefs(self):
        kept[:] += 1.0
        return {**GpsExtrapolation.beliefs(self), "position_w": kept}

    estimator = made({"beliefs": beliefs})
    first = steps(estimator, 1)
    before = first.position_w.copy()
    steps(estimator, 1)
    np.testing.assert_array_equal(first.position_w, before)


def without_one(self):
    return {name: value for name, value in GpsExtrapolation.beliefs(self).items() if name != "heading"}


def fails(self, rows, imu):
    raise RuntimeError("no\nidea")


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"predict": fails}, r"Mine\.predict failed: RuntimeError: no idea \(test_own_filter\.py, line \d+\)"),
        ({"see_heading": lambda self, rows, heading: None}, "Mine.see_heading returned NoneType, it must be an `Up"),
        ({"see_fix": lambda self, rows, fix, force: []}, r"Mine.see_fix returned \[\], it must be a list of one"),
        ({"sound": lambda self: np.ones((2, 3))}, r"Mine.sound returned an array of shape \(2, 3\), it must be \(6,"),
        ({"beliefs": lambda self: 3}, "Mine.beliefs returned no dict; it must be a dict of position_w,"),
        ({"beliefs": without_one}, "Mine.beliefs returned acceleration_bias_b.*; it must be a dict of position_w,"),
        (
            {"beliefs": lambda self: {**GpsExtrapolation.beliefs(self), "heading": np.zeros((6, 1))}},
            r"Mine.beliefs returned heading of shape \(6, 1\), it must be \(6,\)",
        ),
        (
            {"beliefs": lambda self: {**GpsExtrapolation.beliefs(self), "velocity_w": np.full((6, 2), np.nan)}},
            r"Mine.beliefs returned a velocity_w that is not finite, where sound\(\) is true",
        ),
    ],
)
def test_a_mistake_is_one_line_that_names_the_method(changes, told):
    with pytest.raises(InputError, match=f"^method mine: {told}") as raised:
        steps(made(changes))
    assert "\n" not in str(raised.value)


def test_what_else_a_filter_has_is_handed_on():
    assert made({"moments": lambda self: "here"}).filter.moments() == "here"
    assert not hasattr(made().filter, "moments")
