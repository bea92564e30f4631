import mujoco
import numpy as np
import pytest

from dynabot_mj import models
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.plants import scene


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
    # Half-way between the axles' height, 0.1 m but for 0.2 mm, and the tyre's undeformed 0.1042 m.
    assert vehicle.wheel_radius == pytest.approx((scene.read_robot().height + 0.1042) / 2.0, abs=1e-6)
    assert vehicle.wheel_radius == pytest.approx(0.1020, abs=1e-4)
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
    assert abs(np.mean(rate[half:])) / theory == pytest.approx(1.0, abs=0.01)
    assert np.sign(np.mean(rate[half:])) == np.sign(command)
    assert set(contacts) == {4}  # no wheel ever leaves the ground


def test_sensors_of_the_test_bed_are_there(one):
    model, data = rest(one)
    mujoco.mj_forward(model, data)
    names = {model.sensor(i).name for i in range(model.nsensor)}
    wheels = {f"r0/{wheel}_speed" for wheel in scene.WHEELS}
    assert {
        "r0/accelerometer",
        "r0/gyro",
        "r0/magnetometer",
        "r0/position",
        "r0/velocity",
        "r0/hull_contact",
    } | wheels == names
    # At rest the accelerometer feels gravity alone.
    np.testing.assert_allclose(data.sensor("r0/accelerometer").data, [0, 0, 9.81], atol=0.01)


def test_the_vehicles_parameters_by_hand():
    vehicle = scene.read_robot().vehicle
    # Box of the chassis, and four cylinders of radius 0.10 and width 0.07 at (0.17, 0.21), about the vertical.
    wheel = 0.6 * (3.0 * 0.1**2 + 0.07**2) / 12.0 + 0.6 * (0.17**2 + 0.21**2)
    assert vehicle.yaw_inertia == pytest.approx(0.272 + 4.0 * wheel)
    assert vehicle.yaw_inertia == pytest.approx(0.45418)
    sunk = 0.1 - scene.read_robot().height
    assert vehicle.mass_centre_height == pytest.approx((9.6 * 0.09 + 2.4 * 0.10) / 12.0 - sunk, abs=1e-5)
    assert abs(sunk) < 3e-4
    assert vehicle.mass_centre_forward == pytest.approx(0.0, abs=1e-9)
    # Of the motor's nominal 24 V, stall torque 8 Nm and no-load speed 104 rad/s.
    assert vehicle.torque_constant == pytest.approx(24.0 / 104.0)
    assert vehicle.resistance == pytest.approx(24.0 * (24.0 / 104.0) / 8.0)
    assert vehicle.current_limit == pytest.approx(2.0 / (24.0 / 104.0))
    assert (vehicle.voltage, vehicle.servo_gain, vehicle.wheel_damping) == pytest.approx((24.0, 0.5, 0.002))
    assert vehicle.effective_mass == pytest.approx(12.0 + 4.0 * 0.007 / 0.1020**2, rel=1e-3)
    assert vehicle.turning_track == pytest.approx(0.42 + 0.34**2 / 0.42)


def test_a_payload_is_heavier_and_higher():
    bare = scene.read_robot().vehicle
    loaded = scene.read_robot(scene.Conditions(payload=4.0)).vehicle
    assert loaded.mass == pytest.approx(16.0)
    # The box of 0.10 m stands on the hull, whose top is 0.07 m above the axles.
    sunk = 2.0 * (bare.wheel_radius - loaded.wheel_radius)  # of the axles; the contact is half-way
    by_hand = (12.0 * bare.mass_centre_height + 4.0 * (0.10 + 0.07 + 0.05)) / 16.0 - sunk
    assert loaded.mass_centre_height == pytest.approx(by_hand, abs=1e-4)
    assert 0.0 < sunk < 0.001  # little, since the stiffness of MuJoCo's contacts grows with the mass
    # A box of 0.20 x 0.16 m about the vertical.
    assert loaded.yaw_inertia == pytest.approx(bare.yaw_inertia + 4.0 * (0.20**2 + 0.16**2) / 12.0)


def test_friction_is_that_of_the_conditions():
    assert scene.read_robot(scene.Conditions(friction=0.3)).vehicle.friction == 0.3


def test_a_slope_tilts_gravity_and_keeps_its_strength():
    model = scene.compose(1, scene.Conditions(slope=0.2)).compile()
    assert np.linalg.norm(model.opt.gravity) == pytest.approx(9.81)
    assert model.opt.gravity[0] / model.opt.gravity[2] == pytest.approx(0.2)
    assert model.opt.gravity[0] < 0.0  # downhill is -x


def test_a_tether_pulls_outside_and_is_slack_inside():
    model = scene.compose_tethered().compile()
    data = mujoco.MjData(model)
    for radius, pulls in ((6.9, False), (7.01, True)):
        # The post is to the left.
        data.qpos[:3] = 0.0, -radius, scene.read_robot().height
        mujoco.mj_forward(model, data)
        assert (data.sensor("tether_force").data[0] > 0.0) == pulls
        # Tied to the front bumper, 0.25 m ahead of the centre, and level.
        assert data.ten_length[0] == pytest.approx(np.hypot(0.25, radius), abs=1e-4)


def test_a_tethered_field_has_its_conditions_and_survives_the_way_through_xml():
    spec = scene.compose_tethered(scene.Conditions(slope=0.1, payload=2.0, friction=0.4))
    model = spec.compile()
    assert model.opt.gravity[0] < 0.0
    assert model.body_mass.sum() == pytest.approx(14.0)  # the post weighs nothing
    np.testing.assert_array_equal(model.pair_friction[:, 0], 0.4)
    again = mujoco.MjModel.from_xml_string(spec.to_xml())
    np.testing.assert_allclose(again.tendon_range, model.tendon_range)
    np.testing.assert_allclose(again.tendon_solref_lim, model.tendon_solref_lim)


def another(tmp_path, *replacements):
    """Writes the robot's file with some text replaced, and returns its conditions."""
    text = models.path("dynabot.xml").read_text(encoding="utf-8")
    for old, new in replacements:
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "robot.xml").write_text(text, encoding="utf-8")
    return scene.Conditions(model=str(tmp_path / "robot.xml"))


def test_another_robot_with_the_same_names_is_read(tmp_path):
    vehicle = scene.read_robot(another(tmp_path, ('mass="0.6" euler', 'mass="1.2" euler'))).vehicle
    assert vehicle.mass == pytest.approx(9.6 + 4.0 * 1.2)
    assert vehicle.wheel_inertia == pytest.approx(1.2 * 0.1**2 / 2.0 + 0.004)


@pytest.mark.parametrize(
    ("part", "line"), [("actuator", '<dcmotor name="{}"'), ("joint", '<joint name="{}" class="wheel"/>')]
)
def test_a_robot_whose_wheels_are_in_another_order_is_refused(part, line, tmp_path):
    # Commands go to the motors by their places: these would drive the wrong wheels.
    one, other = line.format("front_left"), line.format("front_right")
    conditions = another(tmp_path, (one, "aside"), (other, one), ("aside", other))
    with pytest.raises(InputError, match=rf"{part}s .*front_right, front_left, .*; it needs .*, in this order"):
        scene.read_robot(conditions)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('<joint name="rear_left"', '<joint name="other"', "no joint named 'rear_left'"),
        ('<dcmotor name="front_right"', '<dcmotor name="other"', "no actuator named 'front_right'"),
        ('name="rear_right_tyre"', 'name="other"', "no geom named 'rear_right_tyre'"),
        ('name="hull"', 'name="other"', "no geom named 'hull'"),
        ('<freejoint name="free"/>', '<freejoint name="loose"/>', "no joint named 'free'"),
        ("<worldbody>", "<worldbody", "cannot be read"),
        ('condim="3"', 'condom="3"', "unrecognized attribute: 'condom'"),
        ('controller="0 0 0.5 0 0 24"', 'controller="0 0 x"', "cannot be read"),
        ('joint="rear_left"', 'joint="other"', "actuator 'rear_left' moves no joint of the robot"),
        ('input="vel ff"', 'input="vel"', "actuator 'front_left' must be a dcmotor with input"),
    ],
)
def test_a_robot_that_lacks_something_is_refused_with_its_name(old, new, message, tmp_path):
    conditions = another(tmp_path, (old, new))
    # The same error is said again when somebody asks again.
    for _ in range(2):
        with pytest.raises(InputError, match=message) as error:
            scene.read_robot(conditions)
        assert "\n" not in str(error.value)
        assert conditions.model in str(error.value)


def test_a_robot_with_a_wheel_in_the_air_is_refused(tmp_path):
    conditions = another(tmp_path, ('pos="-0.17 0.21 0"', 'pos="-0.17 0.21 0.05"'))
    with pytest.raises(InputError, match="does not come to rest on its four tyres"):
        scene.read_robot(conditions)


def test_a_model_that_is_no_file_or_no_mjcf_is_refused(tmp_path):
    with pytest.raises(InputError, match="must be 'dynabot' or an MJCF file"):
        scene.read_robot(scene.Conditions(model=str(tmp_path / "absent.xml")))
    with pytest.raises(InputError, match="must be 'dynabot' or an MJCF file"):
        scene.read_robot(scene.Conditions(model=str(tmp_path)))
    (tmp_path / "text.xml").write_text("not XML at all")
    with pytest.raises(InputError, match="cannot be read"):
        scene.read_robot(scene.Conditions(model=str(tmp_path / "text.xml")))
    right = models.path("dynabot.xml").read_bytes()
    (tmp_path / "latin.xml").write_bytes(right.replace(b'name="front_left_tyre"', b'name="front_left_\xff"'))
    with pytest.raises(InputError, match="cannot be read"):
        scene.read_robot(scene.Conditions(model=str(tmp_path / "latin.xml")))
    (tmp_path / "binary.xml").write_bytes(bytes(range(256)))
    with pytest.raises(InputError, match="cannot be read"):
        scene.read_robot(scene.Conditions(model=str(tmp_path / "binary.xml")))
