from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.experiments.vehicle import period_ends
from dynabot_mj.study import assembly, configuration, scenario


@pytest.fixture
def parts():
    """Particles of 12 kg that act every 10 ms for 0.5 s, all under 24 N toward +x."""
    setup = configuration.build({}, plants=["particle"], estimators=["perfect"], duration=0.5)
    (case,) = scenario.cases(setup)
    push = np.broadcast_to([24.0, 0.0], (2, 3, 2))
    return replace(assembly.parts(setup, case, range(2)), law=lambda known: push)


def test_the_start_and_the_end_of_every_period_are_kept(parts):
    start_w = parts.plant.state.position_w
    ends = period_ends.drive(parts)
    time = 0.01 * np.arange(51)
    np.testing.assert_allclose(ends.time, time, atol=1e-12)
    # 2 m/s^2.
    speed = np.broadcast_to(2.0 * time[:, None, None], ends.heading.shape)
    np.testing.assert_allclose(ends.velocity_w[..., 0], speed, atol=1e-12)
    np.testing.assert_allclose(ends.position_w[..., 0] - start_w[..., 0], 0.25 * speed**2, atol=1e-12)
    np.testing.assert_array_equal(ends.position_w[-1], parts.plant.state.position_w)
    assert not ends.diverged.any()


def test_when_a_trial_broke_down_is_kept(parts):
    # 6 kN are 500 m/s^2: beyond 1,000 m/s after 2 s, at the end of a period of 1 s.
    long = replace(parts.clocks, sample_ticks=1000, control_ticks=1000, duration_ticks=4000)
    push = np.broadcast_to([6000.0, 0.0], (2, 3, 2)) * np.array([1.0, 0.1])[:, None, None]
    ends = period_ends.drive(replace(parts, clocks=long, law=lambda known: push))
    np.testing.assert_array_equal(ends.diverged.T, [[False, False, True, True, True], [False] * 5])
