import math

import numpy as np
import pytest

from dynabot_mj.experiments.vehicle import formation_tracking
from dynabot_mj.study import configuration


def test_a_formation_of_bodies_stays_near_its_particles():
    setup = configuration.build({"method": {"perfect": {"sample_period": 0.036}}}, duration=3.0)
    found = formation_tracking.follow(setup, range(4))
    # Robots of 4 m side are pushed apart at once; what turning first costs in 3 s is well under a metre.
    assert 0.05 < found.velocity_error < 0.7
    assert 0.05 < found.position_error < 0.8
    assert not found.diverged.any()
    assert len(found.velocity_error_by_time) == 3  # of 84 periods, 3.024 s
    squares = found.velocity_error_by_time**2
    weights = np.bincount([int(event * 0.036) for event in range(84)])
    assert found.velocity_error == pytest.approx(math.sqrt((squares * weights).sum() / 84))
    assert np.isnan(found.rigid.settling).all()  # too short to settle


@pytest.mark.slow
def test_tuned_robots_settle_like_particles_with_perfect_information():
    for period, alpha_h in ((0.010, 650.0), (0.027, 650.0), (0.036, 650.0), (0.156, 500.0)):
        tree = {"method": {"perfect": {"sample_period": period, "alpha_h": alpha_h}}}
        found = formation_tracking.follow(configuration.build(tree, seed=11), range(30))
        ratio = found.rigid.settling.mean() / found.particle.settling.mean()
        assert 0.97 < ratio < 1.03
        if alpha_h == 650.0:  # with the softer well at 156 ms a formation may come to rest turned by some metres
            assert found.position_error < 0.7
        assert found.yaw_path.max() < 1.5  # no limit cycle; a robot may turn once more late on
        assert not found.rigid.collision_footprint.any()
