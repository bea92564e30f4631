import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynabot_mj.metrics import (
    Formation,
    Scorer,
    footprints_touch,
    neighbour_distances,
    polygon_error,
    polygon_radius,
    settling_time,
)
from dynabot_mj.plants import FleetState

FORMATION = Formation(
    well_radius=3.0,
    spacing=np.sqrt(27.0),
    width=1.0,
    settling_band=0.5,
    tolerance=1.1,
    collision_distance=0.4,
    length=0.5,
    breadth=0.49,
)


def polygon(robots, radius, turn=0.0):
    angle = turn + 2 * np.pi * np.arange(robots) / robots
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def test_settling_of_an_exponential_approach():
    time = np.arange(0.0, 80.0, 0.01)
    radius = 3.0 + 47.0 * np.exp(-time / 5.0)
    # The trailing 3 s mean of exp(-t / tau) is exp(-t / tau) tau (e^{3 / tau} - 1) / 3; it passes 0.5 m at
    # t = tau ln(94 tau (e^{3 / tau} - 1) / 3).
    exact = 5.0 * np.log(94.0 * 5.0 * (np.exp(0.6) - 1.0) / 3.0)
    assert settling_time(time, radius[:, None], 0.5)[0] == pytest.approx(exact, abs=0.03)


def test_a_signal_that_is_outside_at_the_end_has_not_settled():
    time = np.arange(0.0, 80.0, 0.1)
    drifting, still = 3.0 + 0.3 * np.maximum(time - 70.0, 0.0), np.full_like(time, 3.0)
    settling = settling_time(time, np.stack([drifting, still], axis=-1), 0.5)
    assert np.isnan(settling[0])
    assert settling[1] == 0.0


@given(turn=st.floats(-np.pi, np.pi), robots=st.integers(2, 7), seed=st.integers(0, 1000))
def test_a_perfect_polygon_has_no_error_whatever_its_turn_and_order(turn, robots, seed):
    positions = np.random.default_rng(seed).permutation(polygon(robots, 3.3, turn))
    assert polygon_error(positions, 3.3) == pytest.approx(0.0, abs=1e-12)


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


def test_the_polygons_radius_is_the_middle_of_what_the_floors_admit():
    # Three robots: the floor between them ends at (d0 + 1) / sqrt(3) = 3.577 m, before the leader's at 4 m.
    assert polygon_radius(FORMATION, 3) == pytest.approx((3.0 + (np.sqrt(27.0) + 1) / np.sqrt(3.0)) / 2)
    assert polygon_radius(FORMATION, 3) == pytest.approx(3.289, abs=5e-4)


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


def run(position_at, duration=20.0, formation=FORMATION, period=0.01):
    """Scores one trial whose robots' positions are given by a function of time."""

    def state(time):
        position = np.asarray(position_at(time), float)[None]
        zero = 0.0 * position
        return FleetState(
            time=time,
            position_w=position,
            velocity_w=zero,
            heading=zero[..., 0],
            yaw_rate=zero[..., 0],
            specific_impulse_b=zero,
        )

    scorer = Scorer(formation, np.zeros(2), state(0.0), duration)
    for k in range(round(duration / period)):
        scorer.control(state(k * period))
        scorer.look(state((k + 1) * period))
    scorer.control(state(duration))
    return scorer.scores()


def test_a_resting_polygon_completes():
    scores = run(lambda time: polygon(3, 3.3))
    assert scores.completion[0] == scores.completion_common[0] == scores.settled[0] == 1.0
    assert scores.settling[0] == 0.0
    assert not scores.collision[0]


def test_a_collision_at_any_time_fails_the_trial_although_it_ends_well():
    def crossing(time):
        positions = polygon(3, 3.3)
        if 5.0 <= time < 5.015:
            positions[0] = positions[1] + [0.39, 0.0]
        return positions

    scores = run(crossing)
    assert scores.collision[0]
    assert scores.collision_footprint[0]
    assert scores.completion[0] == scores.completion_common[0] == 0.0
    assert np.isnan(scores.settling[0])
    assert np.isnan(scores.settled[0])


def test_hulls_touch_before_centres_collide():
    def near(time):
        positions = polygon(3, 3.3)
        positions[0] = positions[1] + [0.45, 0.0]
        return positions

    scores = run(near)
    assert scores.collision_footprint[0]
    assert not scores.collision[0]


def test_one_robot_off_its_corner_at_one_instant_fails_completion():
    def late(time):
        positions = polygon(3, 3.3)
        if abs(time - 15.0) < 0.006:
            positions[0] *= 2.0
        return positions

    assert run(late).completion[0] == 0.0
    assert run(lambda time: late(time) if time < 9.0 else polygon(3, 3.3)).completion[0] == 1.0


def test_without_uncertainty_the_annulus_decides():
    exact = Formation(**{**FORMATION.__dict__, "tolerance": 0.0})
    assert run(lambda time: polygon(3, 4.04), formation=exact).completion[0] == 1.0
    assert run(lambda time: polygon(3, 4.06), formation=exact).completion[0] == 0.0
    assert run(lambda time: polygon(3, 2.94), formation=exact).completion[0] == 0.0


def excursion(time):
    """A polygon that is 0.5 m out of place for an instant, five seconds before the end."""
    positions = polygon(3, 4.0)
    if abs(time - 15.0) < 0.006:
        positions[0] *= 1.5
    return positions


def test_annulus_and_band_hold_through_the_last_ten_seconds():
    exact = Formation(**{**FORMATION.__dict__, "tolerance": 0.0})
    assert run(excursion, formation=exact).completion[0] == 0.0
    assert run(excursion).completion_common[0] == 0.0
    earlier = run(lambda time: excursion(time + 6.0) if time < 9.5 else polygon(3, 4.0), formation=exact)
    assert earlier.completion[0] == earlier.completion_common[0] == 1.0


def test_band_of_one_metre_bounds_radii_and_sides():
    # Radii 2 to 5 m and sides sqrt(27) - 1 to sqrt(27) + 2 m; the side of a triangle is sqrt(3) times its radius.
    for radius, inside in ((2.41, 0.0), (2.43, 1.0), (4.15, 1.0), (4.16, 0.0)):
        assert run(lambda time, r=radius: polygon(3, r)).completion_common[0] == inside
    squashed = np.array([[3.5, 0.0], [3.4, 1.0], [-3.5, 0.0]])
    assert run(lambda time: squashed).completion_common[0] == 0.0


def test_short_runs_are_not_judged():
    scores = run(lambda time: polygon(3, 3.3), duration=12.9)
    for name in ("settling", "settled", "completion", "completion_common"):
        assert np.isnan(getattr(scores, name)[0])


def test_top_speed_counts_the_fastest_robot():
    state = FleetState(
        time=0.0,
        position_w=polygon(3, 3.0)[None],
        velocity_w=np.array([[[3.0, 4.0], [0.0, 0.0], [1.0, 0.0]]]),
        heading=np.zeros((1, 3)),
        yaw_rate=np.zeros((1, 3)),
        specific_impulse_b=np.zeros((1, 3, 2)),
    )
    assert Scorer(FORMATION, np.zeros(2), state, 5.0).scores().top_speed[0] == pytest.approx(5.0)
