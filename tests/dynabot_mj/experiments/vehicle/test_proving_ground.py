import math
from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.experiments.vehicle.proving_ground import TURNING, ProvingGround
from dynabot_mj.plants import scene


def test_a_trace_knows_headings_frames_and_contacts():
    ground = ProvingGround(scene.NOMINAL, 0.004)
    left = ground.run(0.2, 0.5 * TURNING, heading=math.pi / 2.0, motion=(1.0, 0.0, 0.0))
    assert left.heading[0, 0] == pytest.approx(math.pi / 2.0)
    np.testing.assert_allclose(left.velocity_b[0, 0], [1.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(left.qvel[0, 0, :2], [0.0, 1.0], atol=1e-12)
    assert left.forward[-1, 0] > 0.0
    assert abs(left.sideways[-1, 0]) < 1e-3
    assert set(left.contacts) == {4}
    assert left.touched == len(left.time) - 1  # nothing does


def test_slippery_ground_limits_the_deceleration_to_mu_g():
    ground = ProvingGround(replace(scene.NOMINAL, friction=0.3), 0.004)
    brake = ground.run(3.0, 0.0, motion=(5.0, 0.0, 0.0))
    sliding = brake.time < 0.8  # the wheels are locked
    rate = -np.polyfit(brake.time[sliding], brake.velocity_b[sliding, 0, 0], 1)[0]
    assert rate == pytest.approx(0.3 * 9.81, rel=0.05)
