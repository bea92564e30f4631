"""What is seen of the overlays, in pictures of real trials in which something was changed."""

from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.film import film
from dynabot_mj.film.shot import OVERLAYS, Shot

from .conftest import SMALL, K, picture

pytestmark = pytest.mark.usefixtures("graphics")


def test_trails_grow(taken):
    lengths = []
    for k in (2, 20, 39):
        bare, trailed = picture(taken, k, only=()), picture(taken, k, only={"trails"})
        lengths.append(int((np.abs(bare - trailed).max(axis=-1) > 20).sum()))
    assert lengths == sorted(lengths)
    assert lengths[-1] > 2 * lengths[0]


@pytest.mark.parametrize("overlay", OVERLAYS)
def test_each_overlay_is_seen_and_can_be_hidden(taken, overlay):
    others = [one for one in OVERLAYS if one not in (overlay, "strip")]
    # The strip makes the scene lower, so it is looked at by its height.
    if overlay == "strip":
        assert (picture(taken)[-20:] < 60).mean() > 0.6
        assert (picture(taken, only=others)[-20:] < 60).mean() < 0.1
        return
    shown, hidden = picture(taken, only=[*others, overlay]), picture(taken, only=others)
    assert (np.abs(shown - hidden).max(axis=-1) > 20).sum() > 10


def with_messages(taken, *, arrives_at, lost):
    """One message, of robot 1 to robot 3, sent a little before the frame K."""
    one = taken.recording
    nobody = np.full((1, 3), np.inf)
    nobody[0, 2] = arrives_at
    messages = replace(
        one.messages,
        sent_at=np.array([one.time[K] - 0.02]),
        sender=np.array([0]),
        arrives_at=nobody,
        lost=np.array([[False, False, lost]]),
    )
    return replace(taken, recording=replace(one, messages=messages))


def red(seen):
    """Returns which pixels have the colour of what was lost."""
    return np.abs(seen - np.array([219, 13, 13])).max(axis=-1) < 25


def test_a_message_flashes_when_it_arrives_and_a_lost_one_is_red(taken):
    time = taken.recording.time[K]
    quiet = picture(with_messages(taken, arrives_at=np.inf, lost=False), only={"links"})
    on_its_way = picture(with_messages(taken, arrives_at=time + 0.01, lost=False), only={"links"})
    arrived = picture(with_messages(taken, arrives_at=time - 0.01, lost=False), only={"links"})
    lost = picture(with_messages(taken, arrives_at=np.inf, lost=True), only={"links"})
    np.testing.assert_array_equal(on_its_way, quiet)
    flash = np.abs(arrived - quiet).max(axis=-1) > 15
    assert flash.sum() > 20
    assert not red(arrived).any()
    assert red(lost).sum() > 15
    later = picture(with_messages(taken, arrives_at=time - 0.01, lost=False), K + 8, only={"links"})
    np.testing.assert_array_equal(
        later, picture(with_messages(taken, arrives_at=np.inf, lost=False), K + 8, only={"links"})
    )


@pytest.mark.parametrize(("speed", "arrived_s", "lost_s"), [(0.1, 0.01, 0.05), (1.0, 0.1, 0.5), (10.0, 1.0, 1.0)])
def test_messages_are_shown_for_a_while_of_film_or_simulation(taken, speed, arrived_s, lost_s):
    """Slowed down for 0.1 and 0.5 s of film, quickened for as much of the simulation, but for a frame at least."""

    def seen(age, lost):
        time = taken.recording.time[K]
        what = with_messages(taken, arrives_at=np.inf if lost else time - age, lost=lost)
        sent_at = np.array([time - age - 0.3 * (not lost)])  # the slowest of messages
        messages = replace(what.recording.messages, sent_at=sent_at)
        shown = picture(
            replace(what, recording=replace(what.recording, messages=messages)), speed=speed, only={"links"}
        )
        return bool((np.abs(shown - quiet) > 15).any())

    quiet = picture(with_messages(taken, arrives_at=np.inf, lost=False), speed=speed, only={"links"})
    assert seen(0.9 * arrived_s, lost=False)
    assert not seen(1.1 * arrived_s, lost=False)
    assert seen(0.9 * lost_s, lost=True)
    assert not seen(1.1 * lost_s, lost=True)


def test_a_lost_message_is_red_on_its_senders_half(taken):
    with film.opened(taken, replace(Shot(**SMALL), overlays=frozenset({"links"}), camera="top")) as drawn:
        places, _ = drawn.view(K).project(np.c_[taken.recording.position_w[K], np.full(3, 0.24)])
    lost = picture(with_messages(taken, arrives_at=np.inf, lost=True), only={"links"}, camera="top")
    rows, columns = np.nonzero(red(lost))
    middle = np.array([columns.mean() / 240.0 - 1.0, 1.0 - rows.mean() / 136.0])
    assert np.hypot(*(middle - places[0])) < np.hypot(*(middle - places[2]))


def test_collisions_are_red(taken):
    collided = taken.collided.copy()
    collided[K, 1] = True
    assert not red(picture(taken, only={"marks"})).any()
    assert red(picture(replace(taken, collided=collided), only={"marks"})).sum() > 20


def test_through_the_eyes_of_a_robot_neighbours_are_where_it_heard_of_them(taken):
    one = taken.recording
    heard_w = one.heard_w.copy()
    heard_w[K, 0, 2] = one.position_w[K, 2] + 3.0
    moved = replace(taken, recording=replace(one, heard_w=heard_w))
    shown = {"only": {"beliefs"}, "camera": "top"}
    seen = np.abs(picture(taken, eyes_of=0, **shown) - picture(moved, eyes_of=0, **shown)).max(axis=-1) > 15
    assert seen.sum() > 10
    np.testing.assert_array_equal(picture(taken, eyes_of=1, **shown), picture(moved, eyes_of=1, **shown))
    np.testing.assert_array_equal(picture(taken, **shown), picture(moved, **shown))


def test_an_ellipse_has_the_size_that_the_robot_believes(taken):
    """Drawn alone on the map, its extent is that of one standard deviation."""
    one = replace(taken.recording, believed_w=taken.recording.believed_w.copy())
    covariance = np.full_like(one.covariance, np.nan)
    turn = np.array([[np.cos(0.5), -np.sin(0.5)], [np.sin(0.5), np.cos(0.5)]])
    covariance[K] = turn @ np.diag([4.0, 0.25]) @ turn.T
    one.believed_w[K, 1:] = np.nan
    widened = replace(taken, recording=replace(one, covariance=covariance), beside=None)
    shot = replace(Shot(width=1280, height=720), overlays=frozenset({"beliefs"}), camera="top")
    with film.opened(widened, shot) as drawn:
        seen, view = drawn.frame(K).astype(int), drawn.view(K)
    unknown = replace(widened.recording, believed_w=one.believed_w * np.nan)
    with film.opened(replace(widened, recording=unknown), shot) as drawn:
        bare = drawn.frame(K).astype(int)
    rows, columns = np.nonzero(np.abs(seen - bare).max(axis=-1) > 15)
    pixel = 2.0 * view.slope_x * view.distance / 1280  # [m], at the ground
    # An ellipse reaches to the square roots of the variances along the axes. It is drawn 2 % nearer to the camera than
    # the ground, and a line is 2 pixels wide.
    along_x, along_y = np.sqrt(np.diag(covariance[K, 0]))
    assert np.ptp(columns) * pixel == pytest.approx(2.0 * along_x, rel=0.04, abs=3 * pixel)
    assert np.ptp(rows) * pixel == pytest.approx(2.0 * along_y, rel=0.04, abs=3 * pixel)
    assert np.corrcoef(columns, -rows)[0, 1] > 0.5  # its long axis points up to the right


def test_arrows_point_where_the_command_does(taken):
    one = taken.recording
    shots = {"only": {"forces"}, "camera": "top"}
    quiet = replace(taken, recording=replace(one, force_w=np.zeros_like(one.force_w)))
    bare, places = picture(quiet, **shots), []
    for direction in ([50.0, 0.0], [0.0, 50.0]):
        force_w = np.zeros_like(one.force_w)
        force_w[K, 0] = direction
        seen = picture(replace(taken, recording=replace(one, force_w=force_w)), **shots)
        rows, columns = np.nonzero(np.abs(seen - bare).max(axis=-1) > 40)
        places.append((columns.mean(), -rows.mean()))
    east, north = places
    assert east[0] > north[0] + 3
    assert north[1] > east[1] + 3
