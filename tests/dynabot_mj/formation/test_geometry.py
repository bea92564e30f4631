import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynabot_mj.formation.geometry import footprints_touch, neighbour_distances, polygon_error


def polygon(robots, radius, turn=0.0):
    angle = turn + 2 * np.pi * np.arange(robots) / robots
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


@given(turn=st.floats(-np.pi, np.pi), robots=st.integers(2, 7), seed=st.integers(0, 1000))
def test_a_perfect_polygon_has_no_error_whatever_its_turn_and_order(turn, robots, seed):
    positions = np.random.default_rng(seed).permutation(polygon(robots, 3.3, turn))
    assert polygon_error(positions, 3.3) == pytest.approx(0.0, abs=1e-12)
    assert polygon_error(positions, 3.3, "largest-error") == pytest.approx(0.0, abs=1e-6)


@given(seed=st.integers(0, 10_000), robots=st.integers(2, 4))
def test_the_fit_is_the_best_of_all_turns_and_orders(seed, robots):
    positions = np.random.default_rng(seed).normal(0.0, 3.0, (robots, 2))
    turns = np.linspace(-np.pi, np.pi, 721)
    corners = np.stack([polygon(robots, 3.3, turn) for turn in turns])
    distance = np.concatenate(
        [
            np.linalg.norm(positions - corners[:, list(order)], axis=-1)
            for order in itertools.permutations(range(robots))
        ]
    )
    squared = (distance**2).sum(axis=-1)
    # The grid misses the best turn by at most a quarter of a degree, 0.0044 rad, which moves a corner by 0.0144 m and,
    # near the minimum, the squared error by less than R sum |z_i| 0.0044^2.
    close = squared <= squared.min() + 3.3 * np.linalg.norm(positions, axis=-1).sum() * 0.0044**2
    assert np.abs(distance[close].max(axis=-1) - polygon_error(positions, 3.3)).min() < 0.0145


@given(seed=st.integers(0, 10_000), robots=st.integers(2, 4))
def test_the_other_fit_has_the_smallest_largest_error_of_all_turns_and_orders(seed, robots):
    positions = np.random.default_rng(seed).normal(0.0, 3.0, (robots, 2))
    turns = np.linspace(-np.pi, np.pi, 721)
    corners = np.stack([polygon(robots, 3.3, turn) for turn in turns])
    largest = min(
        np.linalg.norm(positions - corners[:, list(order)], axis=-1).max(axis=-1).min()
        for order in itertools.permutations(range(robots))
    )
    found = polygon_error(positions, 3.3, "largest-error")
    # The grid misses the best turn by at most 0.0044 rad, which moves a corner by 0.0144 m.
    assert found <= largest + 1e-9
    assert found >= largest - 0.0145
    assert found <= polygon_error(positions, 3.3) + 1e-9


@pytest.mark.parametrize(
    ("offset", "a", "b", "touch"),
    [
        ((0.499, 0.0), 0.0, 0.0, True),
        ((0.501, 0.0), 0.0, 0.0, False),
        ((0.0, 0.489), 0.0, 0.0, True),
        ((0.0, 0.491), 0.0, 0.0, False),
        # A corner against a side: half a length and half a diagonal, 0.25 + 0.35.
        ((0.599, 0.0), 0.0, np.pi / 4, True),
        ((0.601, 0.0), 0.0, np.pi / 4, False),
        # Corner to corner along the diagonal: only an axis of the turned rectangle separates them.
        ((0.52, 0.52), 0.0, np.pi / 4, False),
    ],
)
def test_footprints(offset, a, b, touch):
    assert footprints_touch(np.array(offset), np.array(a), np.array(b), 0.5, 0.49) == touch


@given(seed=st.integers(0, 10_000))
def test_overlap_is_symmetric_and_agrees_with_points_inside(seed):
    random = np.random.default_rng(seed)
    offset, (a, b) = random.uniform(-0.8, 0.8, 2), random.uniform(-np.pi, np.pi, 2)
    touch = footprints_touch(offset, np.array(a), np.array(b), 0.5, 0.49)
    assert touch == footprints_touch(-offset, np.array(b), np.array(a), 0.5, 0.49)
    grid = np.stack(np.meshgrid(np.linspace(-0.25, 0.25, 41), np.linspace(-0.245, 0.245, 41)), axis=-1).reshape(-1, 2)
    turn = np.array([[np.cos(b - a), np.sin(b - a)], [-np.sin(b - a), np.cos(b - a)]])
    centre = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]).T @ offset
    inside = np.abs(grid @ turn + centre) <= (0.25, 0.245)
    # Points of a 41 x 41 grid are 0.0125 m apart: an overlap without any is a corner that is hardly in.
    if touch:
        nearest = np.maximum(np.abs(grid @ turn + centre) - (0.25, 0.245), 0.0)
        assert np.hypot(*nearest.T).min() < 0.0125
    assert touch or not inside.all(axis=1).any()


def test_neighbours_around_the_leader():
    square = polygon(4, 2.0)[[2, 0, 3, 1]]
    np.testing.assert_allclose(neighbour_distances(square), np.sqrt(8.0))
