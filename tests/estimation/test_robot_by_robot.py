import numpy as np
import pytest

from dynabot_mj.estimation.filterpy_twins import GpsExtrapolation
from dynabot_mj.estimation.measurements import GpsFix
from dynabot_mj.estimation.robot_by_robot import RobotByRobot


def fixes(*places):
    count = len(places)
    return GpsFix(
        received=np.ones(count, dtype=bool),
        position_w=np.array([[place, 0.0] for place in places]),
        velocity_w=np.zeros((count, 2)),
        age=np.zeros(count),
    )


@pytest.fixture
def three():
    """Three robots, 10 m apart on the x axis."""
    robots = RobotByRobot([GpsExtrapolation() for _ in range(3)])
    robots.begin(slice(None), fixes(0.0, 10.0, 20.0), np.array([0.1, 0.2, 0.3]))
    return robots


@pytest.mark.parametrize(
    ("rows", "places"),
    [
        (slice(None), [5.0, 6.0, 7.0]),
        (np.array([2, 0]), [6.0, 10.0, 5.0]),
        (np.array([False, True, False]), [0.0, 5.0, 20.0]),
    ],
    ids=["all", "in another order", "one"],
)
def test_samples_go_to_the_robots_that_are_meant(three, rows, places):
    count = len(np.arange(3)[rows])
    three.believe_fix(rows, fixes(*(5.0 + k for k in range(count))))
    np.testing.assert_allclose(three.beliefs()["position_w"][:, 0], places)
    np.testing.assert_allclose(three.beliefs()["heading"], [0.1, 0.2, 0.3])


def test_updates_are_stacked_in_the_order_of_the_samples(three):
    update = three.see_heading(np.array([2, 0]), np.array([0.35, 0.08]))
    np.testing.assert_allclose(update.innovation, [[0.05], [-0.02]])
    # What is believed after a bearing is as uncertain as another one: half of the way.
    np.testing.assert_allclose(three.beliefs()["heading"], [0.09, 0.2, 0.325])
    (moved,) = three.see_fix(np.array([1]), fixes(13.0), np.zeros((1, 2)))
    np.testing.assert_allclose(moved.innovation, [[3.0, 0.0, 0.0, 0.0]])


def test_a_broken_robot_is_found_beside_sound_ones(three):
    three.believe_fix(np.array([1]), fixes(np.nan))
    np.testing.assert_array_equal(three.sound(), [True, False, True])
