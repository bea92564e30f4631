import numpy as np
import pytest

from dynabot_mj.plants import LOOK_PERIOD
from dynabot_mj.plants.particle import ParticlePlant
from dynabot_mj.plants.rigid_body import RigidBodyPlant


def place(trials, robots, seed=0):
    random = np.random.default_rng(seed)
    position = 4.0 * np.arange(robots)[None, :, None] + random.uniform(-0.5, 0.5, (trials, robots, 2))
    return position, random.uniform(-np.pi, np.pi, (trials, robots))


def test_robots_start_where_and_as_they_are_put():
    position, heading = place(3, 2)
    state = RigidBodyPlant(position, heading).state
    np.testing.assert_array_equal(state.position_w, position)
    np.testing.assert_allclose(state.heading, heading, atol=1e-12)
    np.testing.assert_array_equal(state.velocity_w, 0.0)


def test_without_force_nothing_moves():
    position, heading = place(2, 3)
    plant = RigidBodyPlant(position, heading)
    for _ in range(20):
        plant.step(np.zeros((2, 3, 2)), 0.036)
    np.testing.assert_allclose(plant.state.position_w, position, atol=1e-4)
    np.testing.assert_allclose(plant.state.heading, heading, atol=1e-4)


@pytest.mark.parametrize(
    ("gap", "local", "step"), [(0.010, 0.010, 0.005), (0.027, 0.027, 0.0045), (0.156, 0.039, 0.004875)]
)
def test_local_period_and_physics_step_divide_the_gap(gap, local, step):
    plant = RigidBodyPlant(*place(1, 1))
    looks = plant.step(np.zeros((1, 1, 2)), gap)
    times = np.array([0.0, *(look.time for look in looks)])
    assert times[-1] == pytest.approx(gap, abs=1e-12)
    assert np.diff(times).max() <= LOOK_PERIOD + 1e-12
    assert plant._timestep[0] == pytest.approx(step)
    assert plant._batch.bind("time")[0] == pytest.approx(gap)
    # Every end of a local period is among the looks, since the laws act there.
    for k in range(1, round(gap / local) + 1):
        assert np.abs(times - k * local).min() < 1e-9


def test_threads_do_not_change_a_bit():
    position, heading = place(6, 3)
    force = np.random.default_rng(1).uniform(-40, 40, (6, 3, 2))
    ends = []
    for threads in (1, 2, 3):
        plant = RigidBodyPlant(position, heading, threads)
        for _ in range(30):
            plant.step(force, 0.036)
        ends.append(plant.state.position_w)
    np.testing.assert_array_equal(ends[0], ends[1])
    np.testing.assert_array_equal(ends[0], ends[2])


def test_a_trial_does_not_depend_on_its_company():
    position, heading = place(5, 2)
    force = np.random.default_rng(1).uniform(-40, 40, (5, 2, 2))
    together, alone = RigidBodyPlant(position, heading), RigidBodyPlant(position[3:4], heading[3:4])
    for _ in range(20):
        together.step(force, 0.027)
        alone.step(force[3:4], 0.027)
    np.testing.assert_array_equal(together.state.position_w[3], alone.state.position_w[0])


@pytest.mark.parametrize("gap", [0.010, 0.036, 0.156])
def test_it_follows_a_point_mass_through_a_steady_force_from_any_heading(gap):
    heading = np.linspace(-np.pi, np.pi, 8, endpoint=False)[:, None]
    position = np.zeros((8, 1, 2))
    rigid, particle = RigidBodyPlant(position, heading), ParticlePlant(12.0, position, heading)
    for _ in range(round(8.0 / gap)):
        for plant in (rigid, particle):
            plant.step(np.array([30.0, 0.0]) - 13.0 * plant.state.velocity_w, gap)
    # The steady speed is F / c = 2.31 m/s for both; the turn at the start costs some way.
    assert np.abs(rigid.state.velocity_w - particle.state.velocity_w).max() < 0.05
    assert np.abs(rigid.state.position_w - particle.state.position_w).max() < 1.5
    assert (rigid.state.position_w[:, 0, 0] > 10.0).all()


def test_the_behaviour_does_not_depend_on_the_worlds_axes():
    turn = np.array([0.0, 0.7, 2.0, -2.5])
    force = 30.0 * np.stack([np.cos(turn + 1.0), np.sin(turn + 1.0)], axis=-1)[:, None]
    plant = RigidBodyPlant(np.zeros((4, 1, 2)), turn[:, None])
    for _ in range(40):
        plant.step(force, 0.036)
    x, y = plant.state.position_w[:, 0].T
    in_own_frame = np.stack([np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x], axis=-1)
    # Tight, but not to the bit: the friction cone's axes are the world's.
    np.testing.assert_allclose(in_own_frame, in_own_frame[:1].repeat(4, axis=0), atol=2e-3)


def test_a_reset_simulation_is_reported_and_keeps_its_last_state(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    position, heading = place(3, 2)
    plant, healthy = RigidBodyPlant(position, heading), RigidBodyPlant(position, heading)
    force = np.ones((3, 2, 2))
    for one in (plant, healthy):
        one.step(force, 0.036)
    before = plant.state
    plant._qvel[1, 0, 0] = np.nan
    for one in (plant, healthy):
        one.step(force, 0.036)
    np.testing.assert_array_equal(plant.diverged, [False, True, False])
    np.testing.assert_array_equal(plant.state.position_w[1], before.position_w[1])
    np.testing.assert_array_equal(plant.state.position_w[[0, 2]], healthy.state.position_w[[0, 2]])
    # MuJoCo's warnings go neither to standard output nor into a log file.
    assert list(tmp_path.iterdir()) == []
    assert capfd.readouterr().out == ""
