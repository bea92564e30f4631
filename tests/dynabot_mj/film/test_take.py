from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.film import take
from dynabot_mj.film.shot import Shot
from dynabot_mj.study import configuration
from dynabot_mj.viewing import recording


@pytest.mark.parametrize(("rate", "speed", "frames"), [(30.0, 1.0, 60), (24.0, 1.0, 48), (10.0, 4.0, 5)])
def test_a_film_is_as_long_as_its_trial(rate, speed, frames):
    setup = configuration.build({}, plants=["particle"], estimators=["gps"], trials=1, duration=2.0)
    shot = Shot(rate=rate, speed=speed)
    what = take.take(setup, shot, beside=False)
    assert what.frames == frames
    assert what.frames / rate == pytest.approx(setup.duration / speed)
    np.testing.assert_allclose(what.recording.time[: what.frames], np.arange(frames) * speed / rate)


def test_point_masses_beside_are_of_the_same_trial_in_step(setup, taken):
    assert taken.beside.case.plant == "particle"
    np.testing.assert_array_equal(taken.beside.position_w[0], taken.recording.position_w[0])
    np.testing.assert_array_equal(taken.beside.time, taken.recording.time)
    assert not np.array_equal(taken.beside.position_w[-1], taken.recording.position_w[-1])
    alone = recording.record(replace(setup, plants=("particle",)), 0.1)
    np.testing.assert_array_equal(taken.beside.position_w, alone.position_w)


def test_progress_goes_on_from_the_first_recording_to_the_second(setup):
    shares = []
    take.take(setup, Shot(rate=5.0), beside=True, progress=shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)


@pytest.mark.parametrize("speed", [1.0, 4.0])
def test_collisions_are_marked_for_a_second_of_film(setup, monkeypatch, speed):
    """Robot 3's hull overlapped another at frame 0, and the centres of the others were too near at frame 2."""
    original = recording.record

    def record(*arguments):
        one = original(*arguments)
        overlapping, near = np.zeros_like(one.overlapping), np.zeros_like(one.near)
        overlapping[0, 2] = near[2, :2] = True
        return replace(one, overlapping=overlapping, near=near)

    monkeypatch.setattr(recording, "record", record)
    found = take.take(setup, Shot(rate=5.0, speed=speed), beside=False).collided
    expected = np.zeros_like(found)
    expected[:5, 2] = True
    expected[2:7, :2] = True  # at speed 4 the film ends before
    np.testing.assert_array_equal(found, expected)


def test_nobody_has_collided_in_a_trial_without_collisions(taken):
    assert not taken.recording.near.any()
    assert not taken.collided.any()
