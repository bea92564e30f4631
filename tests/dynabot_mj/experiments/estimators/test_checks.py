import math

import numpy as np
import pytest

from dynabot_mj.experiments.estimators import checks, kinematic
from dynabot_mj.sensing.options import SensorOptions


def test_the_truth_is_that_of_the_samples_times():
    drives = checks.drive(SensorOptions(), 2, 3, 6.0)
    np.testing.assert_allclose(drives.truth.time, drives.samples.time, atol=1e-9)
    assert drives.truth.interval == pytest.approx(checks.PERIOD)
    # It is the circle of that seed, integrated on a grid of which steps of 3.6 ms meet the corner at which it sets out:
    # 1 m/s^2 (3.6 ms)^2 at most.
    exact = kinematic.follow("circle", 2, 3, 6.0, checks.PERIOD)
    np.testing.assert_allclose(drives.truth.position_w[:160], exact.position_w[:160], atol=1.3e-5)


def test_a_lap_is_once_around():
    assert pytest.approx(2.0 * math.pi) == checks.LAP * kinematic.SPEED / kinematic.RADIUS
