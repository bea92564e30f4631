import numpy as np

from dynabot_mj.perception.belief import certain


def test_a_belief_is_renewed_for_the_robots_that_are_due():
    old, fresh = (certain(np.full((4, 3, 2), x), np.full((4, 3, 2), 2.0 * x)) for x in (0.0, 1.0))
    due = np.ones((4, 3), dtype=bool)
    due[:, 0] = False
    renewed = old.renewed(fresh, due)
    assert (renewed.position_w[:, 0] == 0.0).all()
    assert (renewed.position_w[:, 1:] == 1.0).all()
    assert (renewed.velocity_w[:, 1:] == 2.0).all()
