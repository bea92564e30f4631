import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynabot_mj.plants.particle import ParticlePlant
from dynabot_mj.plants.plant import LONGEST_SUBSTEP

MASS = 12.0


@given(seed=st.integers(0, 2**32 - 1), gap=st.floats(1e-3, 0.4))
def test_a_held_force_matches_the_closed_form(seed, gap):
    random = np.random.default_rng(seed)
    position, force = random.uniform(-50, 50, (4, 3, 2)), random.uniform(-50, 50, (4, 3, 2))
    plant = ParticlePlant(MASS, position, np.zeros((4, 3)))
    for _ in range(5):
        plant.step(force, gap)
    time = 5 * gap
    np.testing.assert_allclose(plant.state.velocity_w, force / MASS * time, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(plant.state.position_w, position + force / MASS * time**2 / 2, rtol=1e-12, atol=1e-12)


def test_looks_are_close_and_end_at_the_gap():
    plant = ParticlePlant(MASS, np.zeros((1, 2, 2)), np.zeros((1, 2)))
    times = [0.0, *(state.time for state in plant.step(np.ones((1, 2, 2)), 0.156))]
    assert len(times) == 17
    assert np.diff(times).max() <= LONGEST_SUBSTEP + 1e-12
    assert times[-1] == pytest.approx(0.156, abs=1e-15)
    assert len(plant.step(np.ones((1, 2, 2)), 0.010)) == 1


def test_dissipation_held_over_a_gap_is_what_the_sampled_loop_feels():
    # v+ = v (1 - c T / m): not the exponential of a continuous damper.
    plant = ParticlePlant(MASS, np.zeros((1, 1, 2)), np.zeros((1, 1)))
    plant.step(np.array([[[120.0, 0.0]]]), 0.1)
    plant.step(-13.0 * plant.state.velocity_w, 0.156)
    assert plant.state.velocity_w[0, 0, 0] == pytest.approx(1.0 * (1 - 13.0 * 0.156 / MASS))


def test_heading_follows_the_velocity_at_a_limited_rate_and_rests_with_the_robot():
    plant = ParticlePlant(MASS, np.zeros((1, 1, 2)), np.zeros((1, 1)))
    force = np.array([[[0.0, 120.0]]])
    headings = [state.heading[0, 0] for _ in range(10) for state in plant.step(force, 0.1)]
    assert headings[0] == 0.0  # 0.1 m/s is below the speed at which it turns
    assert np.diff(headings).max() <= 3.0 * 0.010 + 1e-12
    assert headings[-1] == pytest.approx(np.pi / 2)
    assert not plant.diverged.any()
