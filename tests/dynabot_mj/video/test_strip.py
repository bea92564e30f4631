from dataclasses import replace

import numpy as np

from dynabot_mj.video import strip
from dynabot_mj.video.shot import Shot
from dynabot_mj.video.strip import Numbers, Strip

SHOT = Shot(rate=10.0)


def test_it_is_as_large_as_told_and_its_text_as_large_as_can_be_read(taken):
    seen = Strip(taken, SHOT).draw(3)
    assert seen.shape == (SHOT.strip_height, SHOT.width, 3)
    assert strip._VALUE_SIZE * SHOT.strip_height > 24  # pixels, at 720
    assert strip._LABEL_SIZE * SHOT.strip_height > 14
    bright = seen.max(axis=-1) > 200
    assert 0.02 < bright.mean() < 0.2


def test_nothing_is_written_beyond_its_edge(taken):
    for shot in (SHOT, replace(SHOT, width=640, height=360), replace(SHOT, width=480, height=272)):
        seen = Strip(taken, shot).draw(3)[4:]
        assert (seen[:, -4:].max(axis=-1) < 60).all()


def test_what_changes_is_written_anew(taken):
    drawn = Strip(taken, SHOT)
    first, same, later = drawn.draw(0), drawn.draw(0), drawn.draw(30)
    np.testing.assert_array_equal(first, same)
    assert (first != later).any(axis=-1).sum() > 100


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
