import numpy as np
import pytest

from dynabot_mj.experiments.estimators import crossings, kinematic


def test_errors_at_the_jump_are_told_from_those_elsewhere():
    truth = kinematic.follow("circle", 2, 0, 60.0, 0.1)
    laps = (60.0 - crossings.SETTLED) * kinematic.SPEED / (2.0 * np.pi * kinematic.RADIUS)
    off = np.abs((truth.heading % (2.0 * np.pi)) - np.pi)
    heading = np.where(off < crossings.NEAR, 0.2, 0.1)
    found = crossings.crossing("coupled", truth, 10.0 * heading, heading)
    assert abs(found.crossings - 2.0 * laps) < 2.0
    assert found.near_heading_deg == pytest.approx(np.degrees(0.2))
    assert found.far_largest_heading_deg == pytest.approx(np.degrees(0.1))
    assert found.near_position_m == pytest.approx(2.0 / np.sqrt(2.0))
