from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.perception.surrogates import PerfectPerception
from dynabot_mj.plants.plant import FleetState
from dynabot_mj.testbed.radio import Link, Radio
from dynabot_mj.trial.team import Team

START = FleetState(
    time=0.0,
    position_w=np.array([[[1.0, 2.0], [3.0, 4.0]]]),
    velocity_w=np.array([[[0.5, 0.0], [0.0, 0.5]]]),
    heading=np.zeros((1, 2)),
    yaw_rate=np.zeros((1, 2)),
    velocity_increment_b=np.zeros((1, 2, 2)),
)
BOTH = np.ones((1, 2), dtype=bool)


class Lost(PerfectPerception):
    """The second robot does not know where it is."""

    def observe(self, state, due):
        return replace(super().observe(state, due), known=np.array([[True, False]]))


def team(perception=None, **options):
    """Two robots whose messages take 10 ms."""
    link = Link(offset=10.0, poisson_mean=0.0, tick=1e-3, loss=0.0)
    return Team(perception or PerfectPerception(), Radio(link, 2, 0, [0]), np.zeros(2), START, **options)


def test_robots_know_nothing_before_they_sample():
    fresh = team()
    known = fresh.listen(0.0)
    assert not fresh.belief.known.any()
    assert not known.heard_known.any()
    assert np.isinf(known.heard_age).all()


def test_a_robot_that_is_due_is_heard_by_the_other_after_the_latency():
    found = team()
    sample = found.sample(START, 0.0, np.array([[True, False]]))
    np.testing.assert_array_equal(sample.sent, [[True, False]])
    assert not found.listen(0.009).heard_known.any()
    known = found.listen(0.012)
    np.testing.assert_array_equal(known.heard_known, [[[False, False], [True, False]]])
    np.testing.assert_array_equal(known.heard_position_w[0, 1, 0], [1.0, 2.0])
    assert known.heard_age[0, 1, 0] == pytest.approx(0.012)
    np.testing.assert_array_equal(found.belief.known, [[True, False]])


def test_who_does_not_know_where_it_is_sends_nothing():
    found = team(Lost())
    np.testing.assert_array_equal(found.sample(START, 0.0, BOTH).sent, [[True, False]])
    np.testing.assert_array_equal(found.listen(1.0).heard_known, [[[False, False], [True, False]]])


def test_the_velocity_that_robots_act_on_is_of_the_source_that_was_chosen():
    found = team(velocity=lambda told: 2.0 * told.velocity_w)
    sample = found.sample(START, 0.0, BOTH)
    np.testing.assert_array_equal(found.listen(0.0).velocity_w, 2.0 * START.velocity_w)
    np.testing.assert_array_equal(sample.told.velocity_w, START.velocity_w)  # what the perception says stays
