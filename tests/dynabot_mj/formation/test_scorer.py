from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dynabot_mj.formation.metrics import Formation
from dynabot_mj.formation.scorer import Scorer
from dynabot_mj.plants.plant import FleetState

from .conftest import FORMATION


def polygon(robots, radius, turn=0.0):
    angle = turn + 2 * np.pi * np.arange(robots) / robots
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def run(position_at, duration=20.0, formation=FORMATION, period=0.01, pose_at=lambda time: None):
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
            velocity_increment_b=zero,
            pose=pose_at(time),
        )

    start = state(0.0)
    scorer = Scorer(formation, np.zeros(2), start.heading.shape, duration)
    scorer.substep(start)
    for k in range(round(duration / period)):
        scorer.control(state(k * period))
        scorer.substep(state((k + 1) * period))
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
    assert scores.contact[0] == pytest.approx(5.0)
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


def test_hulls_that_touched_fail_the_common_band_and_not_the_papers_completion():
    def brushing(time):
        positions = polygon(3, 3.3)
        if 2.0 <= time < 2.015:
            positions[0] = positions[1] + [0.45, 0.0]
        return positions

    scores = run(brushing)
    assert (scores.completion[0], scores.completion_common[0]) == (1.0, 0.0)
    assert scores.contact[0] == pytest.approx(2.0)


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
    assert (scores.arrival[0], scores.formation[0], scores.in_band[0]) == (0.0, 0.0, pytest.approx(1.0))


def test_top_speed_counts_the_fastest_robot():
    state = FleetState(
        time=0.0,
        position_w=polygon(3, 3.0)[None],
        velocity_w=np.array([[[3.0, 4.0], [0.0, 0.0], [1.0, 0.0]]]),
        heading=np.zeros((1, 3)),
        yaw_rate=np.zeros((1, 3)),
        velocity_increment_b=np.zeros((1, 3, 2)),
    )
    scorer = Scorer(FORMATION, np.zeros(2), (1, 3), 5.0)
    scorer.substep(state)
    assert scorer.scores().top_speed[0] == pytest.approx(5.0)


def approach(time, speed=1.0):
    """A triangle that shrinks from 13.5 m until it is in the well, and is in the common band from 4.15 m on."""
    return polygon(3, max(13.5 - speed * time, 3.3))


def test_arrival_is_when_the_trailing_mean_comes_to_the_well_and_formation_when_the_band_begins_to_hold():
    scores = run(approach)
    # The mean of a ramp over 3 s lags by 1.5 s (of 301 samples of (t - 3, t]: 1.5 s): 13.5 - (t - 1.5) = 4.5.
    assert scores.arrival[0] == pytest.approx(10.5, abs=0.02)
    # Sides within sqrt(27) + 2, so a radius within 4.1547 m.
    assert scores.formation[0] == pytest.approx(13.5 - (np.sqrt(27.0) + 2.0) / np.sqrt(3.0), abs=0.011)
    assert scores.in_band[0] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("duration", [14.0, 16.0, 30.0])
def test_how_long_the_run_goes_on_changes_neither(duration):
    scores, longer = run(approach, duration), run(approach, 40.0)
    assert scores.arrival[0] == longer.arrival[0]
    # The band begins to hold at 9.35 s: 14 s are too short to see it hold for 5 s.
    assert np.isnan(scores.formation[0]) if duration == 14.0 else scores.formation[0] == longer.formation[0]


def test_an_excursion_resets_the_formation_and_counts_in_the_share_of_the_band_but_arrival_stays():
    def leaving(time):
        return polygon(3, 3.3 if not 2.0 <= time < 4.0 else 6.0)

    scores = run(leaving)
    assert scores.arrival[0] == 0.0
    assert scores.formation[0] == pytest.approx(4.0, abs=0.011)
    assert scores.in_band[0] == pytest.approx(0.9, abs=2e-3)


def test_who_never_comes_has_neither():
    scores = run(lambda time: polygon(3, 20.0))
    for name in ("arrival", "formation", "in_band", "contact", "overturned"):
        assert np.isnan(getattr(scores, name)[0])


def test_an_arrival_at_the_very_end_is_no_event():
    # The mean over (t - 3 s, t] is in the well only at the last sample, which is the end of the run.
    def late(time):
        return polygon(3, 3.3 if time >= 20.0 - 1e-6 else 4.5 + 0.5 * 1.2 / 301)

    assert np.isnan(run(late).arrival[0])


def test_four_robots_are_neighbours_in_the_order_around_the_leader():
    """Diagonals of a square are sqrt(2) sides: outside the band, and not judged."""
    square = replace(FORMATION, well_radius=6.0, spacing=6.0 * np.sqrt(2.0))
    assert run(lambda time: polygon(4, 6.3), formation=square).completion_common[0] == 1.0
    shuffled = run(lambda time: polygon(4, 6.3)[[2, 0, 3, 1]], formation=square)
    assert shuffled.completion_common[0] == 1.0
    assert shuffled.formation[0] == 0.0


@pytest.mark.parametrize(("tilt", "expected"), [(0.0, False), (55.0, False), (65.0, True), (90.0, True), (180.0, True)])
def test_bodies_on_their_side_or_back_are_told_and_have_not_formed(tilt, expected):
    lying = Rotation.from_euler("ZXY", [40.0, tilt, 0.0], degrees=True).as_quat(scalar_first=True)
    pose = np.zeros((1, 3, 11))
    pose[..., 3] = 1.0
    fallen = pose.copy()
    fallen[:, 1, 3:7] = lying
    scores = run(lambda time: polygon(3, 3.3), pose_at=lambda time: fallen if time > 3.0 else pose)
    assert np.isfinite(scores.overturned[0]) == expected
    if expected:
        assert scores.overturned[0] == pytest.approx(3.01)
    assert scores.completion_common[0] == (0.0 if expected else 1.0)


def test_who_is_near_whom_is_told_of_the_latest_state_alone():
    def state(time, second):
        zero = np.zeros((1, 3, 2))
        return FleetState(
            time=time,
            position_w=np.array([[[0.0, 0.0], [second, 0.0], [0.0, 4.0]]]),
            velocity_w=zero,
            heading=zero[..., 0],
            yaw_rate=zero[..., 0],
            velocity_increment_b=zero,
        )

    scorer = Scorer(FORMATION, np.zeros(2), (1, 3), 5.0)
    scorer.substep(state(0.0, 0.45))  # footprints are 0.5 m long
    np.testing.assert_allclose(scorer.distance[0, 0], 0.45)
    np.testing.assert_array_equal(scorer.overlapping, [[True, False, False]])
    np.testing.assert_array_equal(np.stack(scorer.pairs), [[0, 0, 1], [1, 2, 2]])
    scorer.substep(state(0.01, 3.0))
    np.testing.assert_allclose(scorer.distance, [[3.0, 4.0, 5.0]])
    assert not scorer.overlapping.any()
