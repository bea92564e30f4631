import numpy as np
import pytest

from dynabot_mj.estimation.measurements import GpsFix, ImuSample

PERIOD, FIX_EVERY, LATENCY = 0.05, 4, 0.1  # of the drives [s], [samples], [s]


@pytest.fixture
def straight():
    """Samples without errors of robots that drive straight on through the origin at time 0."""

    def samples(count, robots=1, course=0.3, speed=3.0):
        ahead, ones = speed * np.array([np.cos(course), np.sin(course)]), np.ones(robots)
        found = []
        for index in range(count):
            time = index * PERIOD
            imu = ImuSample(
                period=ones * (PERIOD if index else 0.0),
                specific_force_b=np.zeros((robots, 2)),
                yaw_rate=0.0 * ones,
                magnetic_heading=course * ones,
            )
            fix = GpsFix(
                received=ones * (index % FIX_EVERY) == 0,
                position_w=np.tile((time - LATENCY) * ahead, (robots, 1)),
                velocity_w=np.tile(ahead, (robots, 1)),
                age=LATENCY * ones,
            )
            found.append((imu, fix))
        return found

    return samples


@pytest.fixture
def wild():
    """Samples of robots that turn and accelerate at random, each with numbers of its own."""

    def samples(count, robots, seed=0):
        rng = np.random.default_rng(seed)
        found = []
        for index in range(count):
            imu = ImuSample(
                period=np.full(robots, PERIOD if index else 0.0),
                specific_force_b=2.0 * rng.standard_normal((robots, 2)),
                yaw_rate=1.0 + rng.standard_normal(robots),
                magnetic_heading=rng.uniform(-0.2, 0.2, robots) + index * PERIOD,
            )
            fix = GpsFix(
                received=np.full(robots, index % FIX_EVERY == 0),
                position_w=rng.standard_normal((robots, 2)),
                velocity_w=0.3 * rng.standard_normal((robots, 2)),
                age=rng.uniform(0.05, 0.2, robots),
            )
            found.append((imu, fix))
        return found

    return samples
