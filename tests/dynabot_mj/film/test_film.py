"""Pictures of real trials, and of trials in which something was changed to see that it shows."""

from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.common.legend import ROBOT_COLOURS, rgb
from dynabot_mj.film import film, take
from dynabot_mj.film.shot import Shot

from .conftest import SMALL, K, picture

pytestmark = pytest.mark.usefixtures("graphics")


def alike(seen, colour, within=12):
    """Returns which pixels have about a colour."""
    return np.abs(seen - 255.0 * np.array(rgb(colour))).max(axis=-1) < within


def test_a_frame_is_a_picture_of_the_size_asked_for(taken):
    seen = picture(taken)
    assert seen.shape == (272, 480, 3)
    for part in (*np.array_split(seen[:-32], 3), seen[-32:]):
        assert len(np.unique(part.reshape(-1, 3), axis=0)) > 10


@pytest.mark.parametrize("camera", ["orbit", "top", "chase"])
def test_robots_are_where_the_camera_says(taken, camera):
    shot = replace(Shot(**SMALL), overlays=frozenset({"marks"}), camera=camera)
    with film.opened(taken, shot) as drawn:
        seen, view = drawn.frame(K).astype(int), drawn.view(K)
    for robot, place in enumerate(taken.recording.position_w[K]):
        (right, up), depth = view.project(np.array([*place, 0.1]))
        if depth < 0.0 or max(abs(right), abs(up)) > 0.9:
            continue  # a chase does not see all
        row, column = round(0.5 * (1.0 - up) * 272), round(0.5 * (1.0 + right) * 480)
        near = seen[max(0, row - 25) : row + 25, max(0, column - 25) : column + 25]
        assert alike(near, ROBOT_COLOURS[robot]).any()
    if camera != "chase":
        places, _ = view.project(np.concatenate([taken.recording.position_w[K], np.zeros((3, 1))], axis=1))
        assert np.abs(places).max() < 1.0


def test_robots_move_and_wheels_turn(taken):
    first, later = picture(taken, 0, only=()), picture(taken, K, only=())
    assert (np.abs(first - later).max(axis=-1) > 30).sum() > 20
    # Only the wheels are turned; the camera is near, or they would be smaller than a pixel.
    turned = taken.snapshots[K].pose.copy()
    turned[:, 7:] += 0.8
    snapshots = [*taken.snapshots]
    snapshots[K] = replace(snapshots[K], pose=turned)
    shots = {"only": (), "camera": "chase"}
    changed = np.abs(picture(taken, **shots) - picture(replace(taken, snapshots=snapshots), **shots)).max(axis=-1) > 30
    assert 5 < changed.sum() < 3000


def test_ghosts_and_their_ellipses_have_room_in_the_picture(taken):
    """Their distances are Rayleigh distributed: 1.5 deviations per axis hold two thirds of them at the very edge."""
    one = taken.recording
    with film.opened(taken, replace(Shot(**SMALL), camera="top")) as drawn:
        places = [drawn.view(k).project(np.c_[one.believed_w[k], np.zeros(3)])[0] for k in range(0, 40, 4)]
    assert np.abs(places).max() < 1.1
    with film.opened(taken, replace(Shot(**SMALL), camera="top")) as drawn:
        spread = np.sqrt(one.covariance[K, 0, 0, 0])
        beyond = one.position_w[K] + np.array([[0.0, 1.5 * spread]])
        held, _ = drawn.view(K).project(np.c_[beyond, np.zeros(3)])
    assert np.abs(held).max() <= 1.0


def test_what_is_behind_a_camera_that_chases_has_no_number(taken):
    one = taken.recording
    behind = one.position_w.copy()
    ahead = -one.position_w[0, 0] / np.hypot(*one.position_w[0, 0])  # toward the leader
    behind[:, 1] = behind[0, 0] - 9.0 * ahead
    behind[:, 2] = behind[0, 0] - 9.5 * ahead
    behind[:, 0] = behind[0, 0]
    alone = replace(taken, recording=replace(one, position_w=behind), beside=None)
    shots = {"camera": "chase", "only": {"marks"}}
    seen = picture(alone, 0, **shots)
    for colour in ROBOT_COLOURS[1:3]:
        assert not alike(seen, colour).any()
    assert alike(seen, ROBOT_COLOURS[0]).any()


def test_point_masses_alone_are_spheres(setup):
    alone = take.take(replace(setup, plants=("particle",), duration=1.0), Shot(**SMALL), beside=False)
    seen = picture(alone, 5, camera="top", only=())
    assert all(alike(seen, colour, within=70).sum() >= 1 for colour in ROBOT_COLOURS[:3])
