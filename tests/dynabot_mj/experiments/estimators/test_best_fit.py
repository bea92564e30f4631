import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynabot_mj.experiments.estimators import best_fit, kinematic


def on_circle(centre, radius, angle):
    return np.asarray(centre) + radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


@given(
    st.floats(-1e3, 1e3),
    st.floats(-1e3, 1e3),
    st.floats(0.1, 100.0),
    st.floats(0.5, 2.0 * np.pi),
)
def test_a_circle_through_exact_points_is_found_even_from_an_arc(x, y, radius, arc):
    points = on_circle((x, y), radius, np.linspace(0.3, 0.3 + arc, 60))[:, None]
    found = best_fit.circle(points)
    # An arc of half a radian rises by 3 % of the radius: rounding is amplified by the square of that.
    np.testing.assert_allclose(found.centre_w[0], [x, y], atol=1e-6 * radius + 1e-8)
    np.testing.assert_allclose(found.radius, [radius], rtol=1e-6, atol=1e-8)


def test_circles_of_several_runs_are_fitted_each_for_itself():
    angle = np.linspace(0.0, 12.0, 400)
    runs = [on_circle((1.0, 2.0), 7.0, angle), on_circle((-30.0, 0.0), 0.5, angle)]
    found = best_fit.circle(np.stack(runs, axis=1))
    np.testing.assert_allclose(found.centre_w, [[1.0, 2.0], [-30.0, 0.0]], atol=1e-9)
    np.testing.assert_allclose(found.radius, [7.0, 0.5], rtol=1e-9)


def test_the_fit_to_noisy_points_is_the_geometric_one():
    rng = np.random.default_rng(0)
    points = (on_circle((3.0, -1.0), 7.0, rng.uniform(0.0, 2.0 * np.pi, 4000)) + rng.normal(0.0, 0.5, (4000, 2)))[
        :, None
    ]
    found = best_fit.circle(points)
    # sigma sqrt(2 / N) per axis, sigma / sqrt(N) of the radius, which noise along the path lengthens by sigma^2 / 2 R
    np.testing.assert_allclose(found.centre_w[0], [3.0, -1.0], atol=4.0 * 0.5 * np.sqrt(2.0 / 4000))
    assert found.radius[0] == pytest.approx(7.0 + 0.5**2 / 14.0, abs=4.0 * 0.5 / np.sqrt(4000))

    def cost(x, y, radius):
        return ((np.linalg.norm(points[:, 0] - [x, y], axis=-1) - radius) ** 2).sum()

    best = np.append(found.centre_w[0], found.radius)
    for change in np.vstack([np.eye(3), -np.eye(3)]):
        assert cost(*best) < cost(*(best + 1e-3 * change))


@pytest.mark.parametrize("points", [np.zeros((9, 1, 2)), np.linspace((0.0, 0.0), (5.0, 5.0), 9)[:, None]])
def test_points_that_determine_no_circle_are_no_error(points):
    assert np.isfinite(best_fit.fit("circle", points, points).distance).all()


@given(st.floats(-10.0, 10.0), st.floats(-100.0, 100.0), st.floats(-100.0, 100.0))
def test_a_path_is_moved_rigidly_onto_another(turn, x, y):
    path = kinematic.follow("figure-eight", 2, 0, 40.0, 0.5).position_w
    cos, sin = np.cos(turn), np.sin(turn)
    onto = path @ np.array([[cos, sin], [-sin, cos]]) + [x, y]
    np.testing.assert_allclose(best_fit.moved_rigidly(path, onto), onto, atol=1e-9)


def test_a_path_is_neither_scaled_nor_mirrored():
    path = kinematic.follow("figure-eight", 1, 0, 60.0, 0.05).position_w
    moved = best_fit.moved_rigidly(path, 1.5 * path)
    np.testing.assert_allclose(moved - moved.mean(axis=0), path - path.mean(axis=0), atol=1e-9)
    mirrored = path * [1.0, -1.0]
    moved = best_fit.moved_rigidly(path, mirrored)
    assert np.linalg.norm(moved - mirrored, axis=-1).max() > 1.0


def test_the_distance_from_a_path_is_that_from_its_pieces_not_from_its_points():
    angle = np.linspace(0.0, 2.0 * np.pi, 41)
    path = on_circle((0.0, 0.0), 10.0, angle)[:, None]
    between = 0.5 * (path[1:] + path[:-1])
    nearest = best_fit._nearest(path, between)
    np.testing.assert_allclose(nearest, between, atol=1e-12)


@pytest.mark.parametrize("path", kinematic.PATHS)
def test_no_fit_sees_a_shift(path):
    truth = kinematic.follow(path, 2, 3, 60.0, 0.1).position_w[60:]
    np.testing.assert_allclose(best_fit.fit(path, truth + np.array([30.0, -40.0]), truth).distance, 0.0, atol=1e-8)


def test_the_distances_of_known_distortions_are_found():
    angle = np.linspace(0.0, 2.0 * np.pi, 2000, endpoint=False)
    circle = on_circle((1.0, 2.0), 7.0, angle)[:, None]
    # Orthogonal to all that a circle can adapt, so the fits stay and the largest distance is the amplitude.
    oval = on_circle((1.0, 2.0), (7.0 + 0.3 * np.cos(3.0 * angle))[:, None], angle)[:, None]
    assert best_fit.fit("circle", oval, circle).distance.max() == pytest.approx(0.3, rel=0.01)
    way = np.linspace(0.0, 200.0, 2000)
    line = np.stack([way, np.zeros_like(way)], axis=-1)[:, None]
    wavy = np.stack([way + 0.5, 0.2 * np.cos(0.1 * np.pi * way)], axis=-1)[:, None]
    assert best_fit.fit("line", wavy, line).distance.max() == pytest.approx(0.2, rel=0.01)
    eight = kinematic.follow("figure-eight", 1, 0, 60.0, 0.036).position_w[200:]
    dented = eight.copy()
    dented[700] += [0.0, 1.0]
    fitted = best_fit.fit("figure-eight", dented, eight)
    assert fitted.distance.argmax() == 700
    # The path is not perpendicular to the dent there, but no point of it is farther than the dent is deep.
    assert 0.3 < fitted.distance.max() <= 1.0
