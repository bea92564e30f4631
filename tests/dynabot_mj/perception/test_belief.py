import numpy as np

from dynabot_mj.perception.belief import certain
from dynabot_mj.perception.surrogates import GaussMarkovPerception, PerfectPerception
from dynabot_mj.plants.plant import FleetState

ZERO = np.zeros((300, 3, 2))
STATE = FleetState(
    time=0.0,
    position_w=ZERO + 5.0,
    velocity_w=ZERO + 1.0,
    heading=ZERO[..., 0],
    yaw_rate=ZERO[..., 0],
    velocity_increment_b=ZERO,
)
EVERYBODY = np.ones((300, 3), dtype=bool)


def test_uncertainty_is_the_planar_distances():
    perception = GaussMarkovPerception(1.1 / np.sqrt(2.0), 0.08, 0.036, 3, 0, range(300))
    for _ in range(20):
        belief = perception.observe(STATE, EVERYBODY)
    error = belief.position_w - STATE.position_w
    # Mean of 900 squared distances; a sum of two squared normals of variance sigma^2 / 2 has standard deviation
    # sigma^2, so the mean's is sigma^2 / 30.
    assert abs((error**2).sum(axis=-1).mean() - 1.21) < 4.5 * 1.21 / 30.0
    np.testing.assert_array_equal(belief.velocity_w, STATE.velocity_w)


def test_robots_that_are_not_due_keep_their_error():
    perception = GaussMarkovPerception(1.1, 0.08, 0.036, 3, 0, range(300))
    first = perception.observe(STATE, EVERYBODY).position_w
    due = EVERYBODY.copy()
    due[:, 1] = False
    second = perception.observe(STATE, due).position_w
    np.testing.assert_array_equal(second[:, 1], first[:, 1])
    assert (second[:, [0, 2]] != first[:, [0, 2]]).all()


def test_perfect_perception_is_the_truth():
    belief = PerfectPerception().observe(STATE, EVERYBODY)
    np.testing.assert_array_equal(belief.position_w, STATE.position_w)


def test_a_belief_is_renewed_for_the_robots_that_are_due():
    old, fresh = (certain(ZERO + x, ZERO + 2.0 * x) for x in (0.0, 1.0))
    due = EVERYBODY.copy()
    due[:, 0] = False
    renewed = old.renewed(fresh, due)
    assert (renewed.position_w[:, 0] == 0.0).all()
    assert (renewed.position_w[:, 1:] == 1.0).all()
    assert (renewed.velocity_w[:, 1:] == 2.0).all()
