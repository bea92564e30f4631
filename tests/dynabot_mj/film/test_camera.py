import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynabot_mj.film import camera
from dynabot_mj.film.shot import Shot

FOVY = 45.0
METRES = st.floats(-60.0, 60.0)


def on_the_ground(places):
    return np.concatenate([np.asarray(places, dtype=float), np.zeros((len(places), 1))], axis=1)


@given(
    st.lists(st.tuples(METRES, METRES), min_size=1, max_size=9),
    st.floats(-360.0, 360.0),
    st.sampled_from([-90.0, -60.0, -27.0]),
)
def test_a_framing_holds_all_points_and_wastes_no_distance(places, azimuth, elevation):
    points_w = on_the_ground(places)
    view = camera.framing(points_w, azimuth, elevation, camera.lens(Shot(), FOVY))
    where, depth = view.project(points_w)
    assert (depth > 0.0).all()
    assert np.abs(where).max() <= 1.0 / camera._MARGIN + 1e-9
    if view.distance > camera._NEAREST:
        assert np.abs(where).max() == pytest.approx(1.0 / camera._MARGIN, abs=1e-9)


def test_what_is_held_is_in_the_middle_of_the_picture():
    points_w = on_the_ground([[-45.0, 3.0], [-41.0, -5.0], [4.0, 0.0], [0.0, 4.0]])
    where, _ = camera.framing(points_w, 78.0, -27.0, camera.lens(Shot(), FOVY)).project(points_w)
    np.testing.assert_allclose(where.min(axis=0) + where.max(axis=0), 0.0, atol=0.02)  # 13 pixels of 1280


def test_the_map_has_north_up():
    points_w = on_the_ground([[-10.0, 0.0], [10.0, 0.0], [0.0, 5.0]])
    view = camera.Rig(Shot(camera="top"), FOVY, points_w[None, :, :2]).view(0, points_w)
    where, _ = view.project(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]))
    origin, _ = view.project(np.zeros(3))
    east, north = where - origin
    assert east[0] > 0.0
    assert east[1] == pytest.approx(0.0, abs=1e-12)
    assert north[1] > 0.0
    assert north[0] == pytest.approx(0.0, abs=1e-12)


def test_an_orbit_turns_by_the_films_time_not_by_the_simulations():
    points_w = np.zeros((61, 3, 3))
    turned = []
    for shot in (Shot(rate=30.0), Shot(rate=60.0), Shot(rate=30.0, speed=5.0)):
        rig = camera.Rig(shot, FOVY, points_w[..., :2])
        turned.append((rig.view(60, points_w[60]).azimuth - rig.view(0, points_w[0]).azimuth) * shot.rate / 60.0)
    np.testing.assert_allclose(turned, turned[0])
    assert turned[0] > 0.0


def test_a_chase_looks_over_its_robot_toward_the_leader_and_follows_with_a_lag():
    shot = Shot(camera="chase", follow=1)
    position_w = np.tile(np.array([[0.0, 9.0], [-7.0, 0.0], [20.0, 0.0]]), (90, 1, 1))
    position_w[30:, 1] = [0.0, -7.0]  # the leader is north of it at once, and was east before
    rig = camera.Rig(shot, FOVY, position_w)
    seen = [rig.view(k, np.zeros((1, 3))) for k in range(90)]
    azimuths = np.radians([view.azimuth for view in seen])
    assert azimuths[29] == 0.0
    # After its time constant of 0.8 s, here 24 steps, a first-order lag has done 1 - exp(-1) of the turn; in steps it
    # is 1 - (1 - 1/24)^24, which is 0.008 more.
    assert azimuths[30 + 23] / (np.pi / 2.0) == pytest.approx(1.0 - np.exp(-1.0), abs=0.01)
    for k, place in ((0, [-7.0, 0.0, 0.1]), (89, [0.0, -7.0, 0.1])):
        (right, up), depth = seen[k].project(np.array(place))
        assert max(abs(right), abs(up)) < 0.5
        assert depth < 4.0
        leader, beyond = seen[k].project(np.zeros(3))
        assert np.abs(leader).max() < 1.0
        assert beyond > depth
