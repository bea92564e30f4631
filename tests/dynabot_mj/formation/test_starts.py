import numpy as np

from dynabot_mj.formation.options import StartOptions
from dynabot_mj.formation.starts import starts


def test_robots_start_on_a_polygon_fifty_metres_away():
    position, heading = starts(StartOptions(), 3, 0, range(200))
    side = np.linalg.norm(position - np.roll(position, 1, axis=1), axis=-1)
    np.testing.assert_allclose(side, 4.0)
    np.testing.assert_allclose(position.mean(axis=1), np.tile([-50.0, 0.0], (200, 1)), atol=1e-12)
    # Uniform headings: the mean of 600 cosines has standard deviation sqrt(1 / 1200).
    assert abs(np.cos(heading).mean()) < 4.5 / np.sqrt(1200)


def test_headings_may_face_the_leader():
    position, heading = starts(StartOptions(headings="leader"), 3, 0, range(3))
    ahead = position + np.linalg.norm(position, axis=-1, keepdims=True) * np.stack(
        [np.cos(heading), np.sin(heading)], -1
    )
    np.testing.assert_allclose(ahead, 0.0, atol=1e-9)


def test_both_plants_share_starts_and_adding_trials_changes_nothing():
    few, many = starts(StartOptions(), 3, 0, range(3)), starts(StartOptions(), 3, 0, range(10))
    np.testing.assert_array_equal(few[0], many[0][:3])
    np.testing.assert_array_equal(few[1], many[1][:3])
