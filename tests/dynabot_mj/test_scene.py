import mujoco
import numpy as np
import pytest

from dynabot_mj import scene


@pytest.fixture(scope="module")
def one():
    model = scene.compose(1).compile()
    data = mujoco.MjData(model)
    for _ in range(250):
        mujoco.mj_step(model, data)
    return model, data


def rest(one):
    """Returns the model and a copy of the settled state."""
    model, data = one
    copy = mujoco.MjData(model)
    copy.qpos[:], copy.qvel[:] = data.qpos, data.qvel
    return model, copy


def test_vehicle_is_read_from_the_compiled_model():
    vehicle = scene.read_robot().vehicle
    # By hand: 9.6 + 4 x 0.6 kg; cylinder 0.6 x 0.1^2 / 2 + armature 0.004 kg m^2; hull and wheels as in the MJCF.
    assert vehicle.mass == pytest.approx(12.0)
    assert vehicle.wheel_inertia == pytest.approx(0.007)
    assert vehicle.wheel_radius == pytest.approx(0.1, abs=1e-4)
    assert (vehicle.track, vehicle.wheelbase) == pytest.approx((0.42, 0.34))
    assert (vehicle.length, vehicle.breadth) == pytest.approx((0.50, 0.49))
    assert (vehicle.friction, vehicle.torque_limit) == (0.75, 2.0)


def test_seven_robots_compose_with_four_floor_contacts_each():
    model = scene.compose(7).compile()
    assert model.npair == 28
    assert model.nu == 56  # a speed and a torque for each of 28 motors
    assert model.nq == 7 * 11


def test_a_composed_field_survives_the_way_through_xml():
    spec = scene.compose(2)
    model = spec.compile()
    again = mujoco.MjModel.from_xml_string(spec.to_xml())
    assert again.npair == model.npair
    np.testing.assert_allclose(again.pair_solref, model.pair_solref)
    np.testing.assert_allclose(again.body_mass, model.body_mass)


def test_a_robot_at_rest_stands_on_four_wheels_and_stays(one):
    model, data = rest(one)
    start = data.qpos.copy()
    for _ in range(250):
        mujoco.mj_step(model, data)
    assert data.ncon == 4
    np.testing.assert_allclose(data.qpos, start, atol=1e-6)
    assert data.qpos[2] == pytest.approx(scene.read_robot().height, abs=1e-6)


def test_top_speed_and_acceleration_are_those_of_the_paper(one):
    model, data = rest(one)
    data.ctrl[0::2], data.ctrl[1::2] = 200.0, 2.0
    speed = []
    for _ in range(2000):
        mujoco.mj_step(model, data)
        speed.append(data.qvel[0])
    # "10 m/s speed and 0.5g acceleration on hard surfaces".
    assert 10.0 < speed[-1] < 10.6
    assert 0.48 < np.diff(speed).max() / model.opt.timestep / 9.81 < 0.55
    assert abs(data.qpos[1]) < 1e-6 * data.qpos[0]


@pytest.mark.parametrize("timestep", [0.002, 0.005])
@pytest.mark.parametrize("command", [10.0, -30.0])
def test_turning_in_place_obeys_coulomb_friction(one, command, timestep):
    model, data = rest(one)
    keep, model.opt.timestep = model.opt.timestep, timestep
    data.ctrl[0::2] = command * np.array([-1, 1, -1, 1])
    rate, wheel, contacts = [], [], []
    for _ in range(int(3.0 / timestep)):
        mujoco.mj_step(model, data)
        rate.append(data.qvel[5])
        wheel.append(np.abs(data.qvel[6:10]).mean())
        contacts.append(data.ncon)
    model.opt.timestep = keep
    vehicle = scene.read_robot().vehicle
    half = len(rate) // 2
    theory = 2 * vehicle.wheel_radius * np.mean(wheel[half:]) / vehicle.turning_track
    assert 0.95 < abs(np.mean(rate[half:])) / theory < 1.08
    assert np.sign(np.mean(rate[half:])) == np.sign(command)
    assert set(contacts) == {4}  # no wheel ever leaves the ground


def test_sensors_of_the_test_bed_are_there(one):
    model, data = rest(one)
    mujoco.mj_forward(model, data)
    names = {model.sensor(i).name for i in range(model.nsensor)}
    wheels = {f"r0/{wheel}_speed" for wheel in scene.WHEELS}
    assert {"r0/accelerometer", "r0/gyro", "r0/magnetometer", "r0/position", "r0/velocity", "r0/hull_contact"} | wheels == names
    # At rest the accelerometer feels gravity alone.
    np.testing.assert_allclose(data.sensor("r0/accelerometer").data, [0, 0, 9.81], atol=0.01)
