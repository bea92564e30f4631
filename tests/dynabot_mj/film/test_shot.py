import pytest

from dynabot_mj.film.shot import OVERLAYS, Shot


def test_frames_are_apart_by_what_passes_between_them():
    assert Shot(rate=25.0, speed=4.0).interval == pytest.approx(0.16)


@pytest.mark.parametrize(("width", "height"), [(1280, 720), (640, 480), (480, 270), (720, 1280), (322, 242)])
def test_scene_and_strip_fill_an_even_height_together(width, height):
    shot = Shot(width=width, height=height)
    assert shot.strip_height % 2 == 0
    assert shot.scene_height + shot.strip_height == height
    # A ninth of the height, or as high as its texts need on a narrow picture.
    assert shot.strip_height == pytest.approx(min(0.11 * height, width / 16.0), abs=1.0)


def test_without_a_strip_all_is_scene():
    assert Shot(overlays=frozenset(OVERLAYS) - {"strip"}).scene_height == 720
