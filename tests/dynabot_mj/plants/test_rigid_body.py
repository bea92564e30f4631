from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.controllers import gains
from dynabot_mj.controllers.odometry import REAL_SENSORS
from dynabot_mj.plants import scene
from dynabot_mj.plants.local_laws import LocalLaws
from dynabot_mj.plants.particle import ParticlePlant
from dynabot_mj.plants.plant import LONGEST_SUBSTEP, NavigationError
from dynabot_mj.plants.rigid_body import RigidBodyPlant, divided

# The set that no tuning changes.
FIRST = gains.load("first")
LAWS = LocalLaws(steering=FIRST.hand_point, traction=FIRST.traction)
PERIOD = 0.036


def place(trials, robots, seed=0):
    random = np.random.default_rng(seed)
    position = 4.0 * np.arange(robots)[None, :, None] + random.uniform(-0.5, 0.5, (trials, robots, 2))
    return position, random.uniform(-np.pi, np.pi, (trials, robots))


def test_robots_start_where_and_as_they_are_put():
    position, heading = place(3, 2)
    state = RigidBodyPlant(position, heading, LAWS).state
    np.testing.assert_array_equal(state.position_w, position)
    np.testing.assert_allclose(state.heading, heading, atol=1e-12)
    np.testing.assert_array_equal(state.velocity_w, 0.0)


def test_without_force_nothing_moves():
    position, heading = place(2, 3)
    plant = RigidBodyPlant(position, heading, LAWS)
    for _ in range(20):
        plant.step(np.zeros((2, 3, 2)), 0.036)
    np.testing.assert_allclose(plant.state.position_w, position, atol=1e-4)
    np.testing.assert_allclose(plant.state.heading, heading, atol=1e-4)


@pytest.mark.parametrize(
    ("gap", "local", "step"), [(0.010, 0.010, 0.005), (0.027, 0.027, 0.0045), (0.156, 0.039, 0.004875)]
)
def test_local_period_and_physics_step_divide_the_gap(gap, local, step):
    plant = RigidBodyPlant(*place(1, 1), LAWS)
    states = plant.step(np.zeros((1, 1, 2)), gap)
    times = np.array([0.0, *(state.time for state in states)])
    assert times[-1] == pytest.approx(gap, abs=1e-12)
    assert np.diff(times).max() <= LONGEST_SUBSTEP + 1e-12
    assert plant._timestep[0] == pytest.approx(step)
    assert plant._batch.bind("time")[0] == pytest.approx(gap)
    # Every end of a local period is among the substeps, since the laws act there.
    for k in range(1, round(gap / local) + 1):
        assert np.abs(times - k * local).min() < 1e-9


def test_threads_do_not_change_a_bit():
    position, heading = place(6, 3)
    force = np.random.default_rng(1).uniform(-40, 40, (6, 3, 2))
    ends = []
    for threads in (1, 2, 3):
        plant = RigidBodyPlant(position, heading, LAWS, threads=threads)
        for _ in range(30):
            plant.step(force, 0.036)
        ends.append(plant.state.position_w)
    np.testing.assert_array_equal(ends[0], ends[1])
    np.testing.assert_array_equal(ends[0], ends[2])


def test_a_trial_does_not_depend_on_its_company():
    position, heading = place(5, 2)
    force = np.random.default_rng(1).uniform(-40, 40, (5, 2, 2))
    together, alone = RigidBodyPlant(position, heading, LAWS), RigidBodyPlant(position[3:4], heading[3:4], LAWS)
    for _ in range(20):
        together.step(force, 0.027)
        alone.step(force[3:4], 0.027)
    np.testing.assert_array_equal(together.state.position_w[3], alone.state.position_w[0])


@pytest.mark.parametrize("gap", [0.010, 0.036, 0.156])
def test_it_follows_a_point_mass_through_a_steady_force_from_any_heading(gap):
    heading = np.linspace(-np.pi, np.pi, 8, endpoint=False)[:, None]
    position = np.zeros((8, 1, 2))
    rigid, particle = RigidBodyPlant(position, heading, LAWS), ParticlePlant(12.0, position, heading)
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
    plant = RigidBodyPlant(np.zeros((4, 1, 2)), turn[:, None], LAWS)
    for _ in range(40):
        plant.step(force, 0.036)
    x, y = plant.state.position_w[:, 0].T
    in_own_frame = np.stack([np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x], axis=-1)
    # Tight, but not to the bit: the friction cone's axes are the world's.
    np.testing.assert_allclose(in_own_frame, in_own_frame[:1].repeat(4, axis=0), atol=2e-3)


def test_a_reset_simulation_is_reported_and_keeps_its_last_state(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    position, heading = place(3, 2)
    plant, healthy = RigidBodyPlant(position, heading, LAWS), RigidBodyPlant(position, heading, LAWS)
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


def single(trials, laws=LAWS, heading=0.0, **options):
    """Returns a plant with one robot per trial, all at the origin."""
    heading = np.broadcast_to(heading, trials)[:, None]
    return RigidBodyPlant(np.zeros((trials, 1, 2)), heading.astype(float), laws, **options)


def push(plant, force, duration, dissipation=0.0):
    """Pushes all robots alike, and returns the states passed through."""
    states = []
    for _ in range(round(duration / PERIOD)):
        states += plant.step(np.array(force) - dissipation * plant.state.velocity_w, PERIOD)
    return states


@pytest.mark.parametrize("law", [FIRST.hand_point, FIRST.heading], ids=["hand-point", "heading"])
def test_either_law_brings_it_to_the_force_from_any_heading(law):
    heading = np.linspace(-np.pi, np.pi, 12, endpoint=False)
    plant = single(12, LocalLaws(steering=law, traction=FIRST.traction), heading)
    push(plant, [30.0, 0.0], 12.0, dissipation=13.0)
    # F / c = 2.31 m/s along the force, either end first.
    np.testing.assert_allclose(plant.state.velocity_w[:, 0], np.tile([30.0 / 13.0, 0.0], (12, 1)), atol=0.05)
    end = np.cos(plant.state.heading[:, 0])
    assert np.abs(end).min() > 0.99
    if law is FIRST.heading:
        # The nearer end: the rear of those that began facing away, the front of the others.
        clear = np.abs(np.cos(heading)) > 0.1
        np.testing.assert_array_equal(np.sign(end[clear]), np.sign(np.cos(heading[clear])))


def test_a_robot_that_remembers_its_lag_catches_up():
    heading = np.linspace(-np.pi, np.pi, 8, endpoint=False)
    # Of a particle, after t >> m / c: F / c (t - m / c).
    way = 30.0 / 13.0 * (round(14.4 / PERIOD) * PERIOD - 12.0 / 13.0)
    behind = []
    for catch_up in (0.0, 0.5):
        plant = single(8, replace(LAWS, steering=replace(FIRST.hand_point, catch_up=catch_up)), heading)
        push(plant, [30.0, 0.0], 14.4, dissipation=13.0)
        behind.append(np.linalg.norm(plant.state.position_w[:, 0] - [way, 0.0], axis=-1).max())
    assert behind[1] < 0.5 * behind[0]


def test_friction_differs_by_trial():
    friction = np.array([0.1, 0.3, 0.75])
    plant = single(3, friction=friction)
    push(plant, [6.0, 0.0], 4.0)  # 0.5 m/s^2, which each ground gives
    speed, start = plant.state.velocity_w[:, 0, 0], plant.state.position_w[:, 0, 0]
    np.testing.assert_allclose(speed, 2.0, rtol=0.05)
    way = np.max([state.position_w[:, 0, 0] for state in push(plant, [-50.0, 0.0], 4.0)], axis=0) - start
    # 4.2 m/s^2 are asked for. Where friction gives less, the way is v^2 / (2 mu g).
    least = speed**2 / (2.0 * friction * 9.81)
    np.testing.assert_allclose(way[:2], least[:2], rtol=0.05)
    assert way[2] == pytest.approx(speed[2] ** 2 / (2.0 * 50.0 / 12.0), rel=0.5)  # the reversal takes its time
    assert way[2] < 0.7 * way[1] < 0.7 * way[0]


def test_friction_of_one_trial_does_not_depend_on_the_others():
    together, alone = single(3, friction=np.array([0.1, 0.3, 0.75])), single(1, friction=np.array([0.3]))
    same = single(1, conditions=scene.Conditions(friction=0.3))
    for plant in (together, alone, same):
        push(plant, [40.0, 5.0], 1.0)
    np.testing.assert_array_equal(together.state.position_w[1], alone.state.position_w[0])
    np.testing.assert_allclose(same.state.position_w, alone.state.position_w, atol=1e-9)


def test_on_dry_ground_what_is_on_board_is_nearly_the_truth():
    random = np.random.default_rng(2)
    heading, force = random.uniform(-np.pi, np.pi, 6), random.uniform(-30.0, 30.0, (10, 6, 1, 2))
    ends = []
    for on_board in (True, False):
        plant = single(6, replace(LAWS, on_board=on_board), heading)
        for one in force:
            push(plant, one, 1.0, dissipation=13.0)
        ends.append(plant.state.position_w[:, 0])
    # After ten seconds with ten changes of direction, metres from the start.
    assert np.linalg.norm(ends[0] - ends[1], axis=-1).max() < 0.3
    assert not np.array_equal(ends[0], ends[1])


def test_on_slippery_ground_the_traction_law_limits_the_slip():
    # On the true speed: what is on board lets itself be carried along by wheels that slip for long.
    plant = single(1, replace(LAWS, on_board=False), conditions=scene.Conditions(friction=0.1))
    push(plant, [50.0, 0.0], 2.0)
    speed = plant.state.velocity_w[0, 0, 0]
    assert speed == pytest.approx(0.1 * 9.81 * 2.0, rel=0.05)  # all that friction gives
    assert 0.3 < plant.wheel_slip[0] < 1.1 * (FIRST.traction.slip_limit + FIRST.traction.slip_share * speed)
    free = single(1, replace(LAWS, traction=replace(FIRST.traction, slip_limit=50.0), on_board=False),
                  conditions=scene.Conditions(friction=0.1))  # fmt: skip
    push(free, [50.0, 0.0], 2.0)
    assert free.wheel_slip[0] > plant.wheel_slip[0]


def test_wheel_slip_is_the_largest_so_far():
    plant = single(1)
    assert plant.wheel_slip[0] == 0.0
    push(plant, [12.0, 0.0], 2.0)
    # A tyre that carries 1 m/s^2 of 12 kg by a contact damped at v creeps by some centimetres per second.
    assert 0.0 < plant.wheel_slip[0] < 0.05
    push(plant, [0.0, 50.0], 1.0)
    turned = plant.wheel_slip[0]
    assert turned > 0.3  # turning, a skid-steer robot has to slide
    push(plant, [0.0, 0.0], 0.5)
    assert plant.wheel_slip[0] >= turned


def test_hulls_that_meet_are_noted_and_stay_so():
    position = np.array([[[-1.0, 0.0], [1.0, 0.0]]]).repeat(2, axis=0)
    heading = np.array([[0.0, np.pi], [np.pi, 0.0]])
    plant = RigidBodyPlant(position, heading, LAWS)
    force = 30.0 * np.array([[[1.0, 0.0], [-1.0, 0.0]], [[-1.0, 0.0], [1.0, 0.0]]])
    plant.step(force, PERIOD)
    np.testing.assert_array_equal(plant.hull_contact, [False, False])
    push(plant, force, 1.5)
    np.testing.assert_array_equal(plant.hull_contact, [True, False])
    # Hull against hull: as far apart as they are long.
    assert np.ptp(plant.state.position_w[0, :, 0]) == pytest.approx(0.5, abs=0.03)
    push(plant, -force, 2.0)
    assert np.ptp(plant.state.position_w[0, :, 0]) > 1.0
    np.testing.assert_array_equal(plant.hull_contact, [True, False])


def test_a_payload_weighs_in_the_laws_as_on_the_wheels():
    plant = single(1, conditions=scene.Conditions(payload=4.0))
    push(plant, [20.0, 0.0], 2.0)
    # A point mass of 16 kg; 12 kg would reach 3.3 m/s.
    assert plant.state.velocity_w[0, 0, 0] == pytest.approx(20.0 / 16.0 * plant.state.time, rel=0.05)


def test_on_a_slope_it_creeps_downhill():
    # Without integral a wheel turns by torque / gain: 61 mm/s on this slope if it is told to stand, see drive. The
    # reference asks for less speed than it has, by c / (m k) of it.
    plant = single(1, conditions=scene.Conditions(slope=0.1))
    push(plant, [0.0, 0.0], 8.0, dissipation=13.0)
    speed = plant.state.velocity_w[0, 0]
    assert -0.07 < speed[0] < -0.03
    assert abs(speed[1]) < 1e-3


def test_what_is_felt_is_what_mujocos_accelerometer_measures():
    robots, step = 2, 0.005
    plant = RigidBodyPlant(*place(3, robots), LAWS)
    model = scene.compose(robots).compile()
    address = [int(model.sensor(f"{scene.prefix(i)}accelerometer").adr[0]) for i in range(robots)]
    random = np.random.default_rng(4)
    impulse_b, bound, way = np.zeros((3, robots, 2)), np.zeros((3, robots)), 0.0
    for _ in range(12):
        force = random.uniform(-40.0, 40.0, (3, robots, 2))
        for _ in range(40):
            spin = np.abs(plant._qvel[..., 3:6])
            # A gap of one physics step: the sensor then tells the acceleration that the step began with.
            plant.step(force - 13.0 * plant.state.velocity_w, step)
            felt_b = np.stack([plant._sensors[:, a : a + 3] for a in address], axis=1)
            impulse_b += step * felt_b[..., :2]
            way += step * np.linalg.norm(felt_b[..., :2], axis=-1)
            # The sensor's axes are those at the beginning, the plant's the mean of both ends: half the step's rotation.
            spin = np.maximum(spin, np.abs(plant._qvel[..., 3:6]))
            across = spin[..., 2] * np.linalg.norm(felt_b[..., :2], axis=-1)
            bound += step * 0.5 * step * (across + np.linalg.norm(spin[..., :2], axis=-1) * np.abs(felt_b[..., 2]))
            error = np.linalg.norm(plant.state.velocity_increment_b - impulse_b, axis=-1)
            assert (error < 1.1 * bound + 1e-5).all()
    # The bound says something beside all that was felt.
    assert (bound < 0.005 * way).all()


def test_at_rest_on_the_level_nothing_is_felt():
    plant = single(1)
    push(plant, [0.0, 0.0], 2.0)
    np.testing.assert_allclose(plant.state.velocity_increment_b, 0.0, atol=1e-3)


def test_on_a_slope_gravity_is_felt_along_the_way_up():
    heading = np.array([0.0, np.pi / 2.0, np.pi, -np.pi / 2.0])
    plant = single(4, heading=heading, conditions=scene.Conditions(slope=0.1))
    # Creeping at a steady speed, those that face along the slope; see above.
    push(plant, [0.0, 0.0], 8.0, dissipation=13.0)
    before = plant.state
    push(plant, [0.0, 0.0], 1.0, dissipation=13.0)
    felt_b = (plant.state.velocity_increment_b - before.velocity_increment_b)[:, 0] / (plant.state.time - before.time)
    # The way up is ahead, to the right, behind, to the left. The lower tyres yield more, by the moment of 0.1 g about
    # the ground: 2 x 4.4 mm x 0.1 x 0.092 m / 0.34 m at an axle, or 1.4 mrad.
    up_b = np.array([[1.0, 0.0], [0.0, -1.0], [-1.0, 0.0], [0.0, 1.0]])
    np.testing.assert_allclose(felt_b, 9.81 * np.sin(np.arctan(0.1)) * up_b, atol=0.02)


def test_a_rigid_body_and_a_particle_feel_the_same_when_they_accelerate_straight():
    rigid, particle = single(1), ParticlePlant(12.0, np.zeros((1, 1, 2)), np.zeros((1, 1)))
    for plant in (rigid, particle):
        push(plant, [12.0, 0.0], 2.0)
    # 2 m/s; tilted back by 1.4 mrad, see above, the rigid body feels 14 mm/s^2 more.
    np.testing.assert_allclose(rigid.state.velocity_increment_b, particle.state.velocity_increment_b, atol=0.06)
    assert particle.state.velocity_increment_b[0, 0, 0] == pytest.approx(2.0, rel=0.02)


def test_what_is_felt_does_not_depend_on_the_gap():
    # Up to the laws' timing, which is the same here: 36 ms as one gap or as two of 18 would not be.
    plant, same = single(2, heading=[0.0, 1.0]), single(2, heading=[0.0, 1.0])
    for _ in range(20):
        plant.step(np.full((2, 1, 2), 10.0), 0.072)
        for _ in range(2):
            same.step(np.full((2, 1, 2), 10.0), 0.036)
    np.testing.assert_allclose(plant.state.velocity_increment_b, same.state.velocity_increment_b, atol=1e-9)


def test_a_reset_simulation_keeps_what_it_felt_last():
    plant = single(2)
    push(plant, [12.0, 0.0], 0.5)
    before = plant.state.velocity_increment_b
    plant._qvel[1, 0, 0] = np.nan
    push(plant, [12.0, 0.0], 0.5)
    np.testing.assert_array_equal(plant.state.velocity_increment_b[1], before[1])
    assert np.isfinite(plant.state.velocity_increment_b).all()
    assert plant.state.velocity_increment_b[0, 0, 0] > 1.5 * before[0, 0, 0]


def navigation(shape, **errors):
    """Errors of what the local laws run on; those not given are zero."""
    parts = {"heading": np.zeros(shape), "yaw_rate": np.zeros(shape), "acceleration_b": np.zeros((*shape, 2))}
    return NavigationError(**{name: np.zeros_like(part) + errors.get(name, 0.0) for name, part in parts.items()})


def driven(laws, error, duration=3.0, force=(30.0, 0.0), heading=0.0):
    """Drives a robot by a constant force, with sensors that are off by the same all the time."""
    plant = RigidBodyPlant(np.zeros((1, 1, 2)), np.full((1, 1), heading), laws)
    for _ in range(round(duration / PERIOD)):
        plant.step(np.full((1, 1, 2), force), PERIOD, error)
    return plant


def test_real_sensors_without_errors_are_ideal():
    ideal, real = (driven(LAWS, error).state for error in (None, navigation((1, 1))))
    # Accelerometers feel gravity while the robot pitches under acceleration: of the order of 0.02 m/s^2, which is worth
    # 0.02 m/s against the wheels' correction of 1/s, and 6 cm of way in 3 s.
    np.testing.assert_allclose(real.position_w, ideal.position_w, atol=0.1)
    np.testing.assert_allclose(real.heading, ideal.heading, atol=1e-3)


def test_a_robot_goes_straight_where_it_believes_that_the_force_points():
    state = driven(LAWS, navigation((1, 1), heading=0.2), heading=-0.2).state
    assert state.heading[0, 0] == pytest.approx(-0.2, abs=1e-3)
    x, y = state.position_w[0, 0]
    assert x > 5.0
    assert np.arctan2(y, x) == pytest.approx(-0.2, abs=1e-3)


def test_a_gyro_bias_is_followed_until_the_next_sample():
    # Held for a long gap, the believed heading drifts and the robot turns against it.
    plant = RigidBodyPlant(np.zeros((1, 1, 2)), np.zeros((1, 1)), LAWS)
    for _ in range(round(2.0 / PERIOD)):
        plant.step(np.full((1, 1, 2), (30.0, 0.0)), PERIOD)
    plant.step(np.full((1, 1, 2), (30.0, 0.0)), 1.0, navigation((1, 1), yaw_rate=0.1))
    assert plant.state.heading[0, 0] < -0.03


def test_real_gains_bear_an_accelerometer_bias():
    real = replace(LAWS, odometry=REAL_SENSORS)
    biased = navigation((1, 1), acceleration_b=np.array([0.2, 0.2]))
    for laws, holds in ((real, True), (LAWS, False)):
        plant = driven(laws, biased, duration=10.0, force=(0.0, 0.0))
        # At rest, the filter's balance is k d / (1 + (d / s)^2) = 0.2 m/s^2: d = 0.051 m/s for k = 4, s = 0.3.
        off = abs(plant.odometry_w[0, 0, 0] - plant.state.velocity_w[0, 0, 0])
        assert (off < 0.06) == holds


def test_increments_have_the_errors_of_the_period_that_they_were_gathered_in():
    laws = replace(LAWS, odometry=replace(REAL_SENSORS, correction=1e-9, settling=1e-9))  # the accelerometer alone
    plant = RigidBodyPlant(np.zeros((1, 1, 2)), np.zeros((1, 1)), laws)
    for wrong in (1.0, 0.0, 0.0):
        plant.step(np.zeros((1, 1, 2)), PERIOD, navigation((1, 1), acceleration_b=np.array([wrong, 0.0])))
    # Gathered in the first gap, believed at the beginning of the second and kept.
    off = plant.odometry_w[0, 0, 0] - plant.state.velocity_w[0, 0, 0]
    assert off == pytest.approx(1.0 * PERIOD, abs=0.2 * PERIOD)
    plant = RigidBodyPlant(np.zeros((1, 1, 2)), np.zeros((1, 1)), laws)
    for wrong in (0.0, 0.0, 1.0):
        plant.step(np.zeros((1, 1, 2)), PERIOD, navigation((1, 1), acceleration_b=np.array([wrong, 0.0])))
    assert abs(plant.odometry_w[0, 0, 0] - plant.state.velocity_w[0, 0, 0]) < 0.2 * PERIOD


def test_laws_on_the_truth_do_not_look_at_sensors():
    truth = replace(LAWS, on_board=False)
    wrong = navigation((1, 1), heading=0.5, yaw_rate=0.1, acceleration_b=1.0)
    np.testing.assert_array_equal(driven(truth, wrong).state.position_w, driven(truth, None).state.position_w)


def test_odometry_and_reference_are_velocities_of_the_robot():
    plant = driven(LAWS, None)
    np.testing.assert_allclose(plant.odometry_w, plant.state.velocity_w, atol=0.1)
    np.testing.assert_allclose(plant.reference_w, plant.state.velocity_w, atol=0.3)


@pytest.mark.parametrize(
    ("gap", "periods", "steps"), [(0.010, 1, 2), (0.027, 1, 6), (0.036, 1, 8), (0.039, 1, 8), (0.156, 4, 8)]
)
def test_gaps_are_divided_evenly(gap, periods, steps):
    assert divided(gap) == (periods, pytest.approx(gap / periods), steps)
