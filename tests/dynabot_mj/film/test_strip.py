from dataclasses import replace

import numpy as np

from dynabot_mj.film import strip
from dynabot_mj.film.shot import Shot
from dynabot_mj.film.strip import Numbers, Strip

SHOT = Shot(rate=10.0)


def test_it_is_as_large_as_told_and_its_text_as_large_as_can_be_read(taken):
    seen = Strip(taken, SHOT).draw(3)
    assert seen.shape == (SHOT.strip_height, SHOT.width, 3)
    assert strip._VALUE_SIZE * SHOT.strip_height > 24  # pixels, at 720
    assert strip._LABEL_SIZE * SHOT.strip_height > 14
    bright = seen.max(axis=-1) > 200
    assert 0.02 < bright.mean() < 0.2


def test_nothing_is_written_beyond_its_edge(taken):
    for width, height in ((1280, 720), (640, 360), (640, 480), (480, 270), (720, 1280)):
        shot = replace(SHOT, width=width, height=height, eyes_of=0)
        seen = Strip(taken, shot).draw(3)[4:]
        assert (seen[:, -4:].max(axis=-1) < 60).all()
        assert (seen[-2:].max(axis=-1) < 60).all()


def test_texts_do_not_meet(taken):
    """Between the last column of the left and what is written on the right there is a gap, at any size."""
    for width, height in ((1280, 720), (640, 480), (480, 270), (720, 1280)):
        drawn = Strip(taken, replace(SHOT, width=width, height=height, eyes_of=0))
        labels = drawn.draw(3)[4 : round(0.42 * drawn._height)].max(axis=-1) > 90
        left, right = labels[:, : drawn._leader_x], labels[:, drawn._leader_x :]
        assert not left[:, -drawn._gap // 2 :].any()
        assert right.any()


def test_what_changes_is_written_anew(taken):
    """Time, the smallest distance, and each robot's to the leader, each in its place."""
    one = taken.recording
    drawn = Strip(taken, SHOT)
    first, same = drawn.draw(30), drawn.draw(30)
    np.testing.assert_array_equal(first, same)
    time, closest = (x for x, _ in drawn._changing)
    changes = {
        time: replace(one, time=one.time + 2.0),
        closest: replace(one, closest=one.closest + 2.0),
        drawn._leader_x: replace(one, position_w=one.position_w + 7.0),
    }
    for x, changed in changes.items():
        columns = np.flatnonzero(
            (first[4:] != Strip(replace(taken, recording=changed), SHOT).draw(30)[4:]).any(axis=(0, 2))
        )
        assert x <= columns.min() < x + 90


def test_a_collision_is_written(taken):
    collided = taken.collided.copy()
    collided[4] = True
    quiet, alarmed = (Strip(one, SHOT).draw(4) for one in (taken, replace(taken, collided=collided)))
    where = np.nonzero((quiet != alarmed).any(axis=-1))
    assert len(where[0]) > 50
    assert where[1].min() > SHOT.width / 2


def test_numbers_stand_above_their_places_and_not_where_there_is_none():
    picture = np.full((200, 300, 3), 255, dtype=np.uint8)
    Numbers(2, 720).draw(picture, np.array([[0.0, 0.0], [np.nan, np.nan]]))
    rows, columns = np.nonzero((picture != 255).any(axis=-1))
    assert rows.max() <= 100
    assert rows.min() > 60
    assert abs(columns.mean() - 150) < 3
