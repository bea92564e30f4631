import casadi
import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynabot_mj.controllers.design import planar_model
from dynabot_mj.controllers.design.planar_model import STATES
from dynabot_mj.controllers.traction import SIDES
from dynabot_mj.experiments.vehicle.proving_ground import TURNING, ProvingGround
from dynabot_mj.plants import scene

PERIOD = 0.02
VALUES = st.lists(st.floats(-1.0, 1.0), min_size=STATES + 8, max_size=STATES + 8)
SCALE = np.array([1.0, 1.0, 3.0, 4.0, 2.0, 4.0, 60.0, 60.0, 60.0, 60.0])  # of a state


@pytest.fixture(scope="module")
def robot():
    return scene.read_robot().vehicle


@pytest.fixture(scope="module")
def functions(robot):
    """The model as functions of numbers: torque of the motors, derivative of the state, slips."""
    x, w, t = casadi.SX.sym("x", STATES), casadi.SX.sym("w", 4), casadi.SX.sym("t", 4)

    def numeric(inputs, output):
        function = casadi.Function("f", inputs, [output])
        return lambda *values: np.array(function(*values)).ravel()

    slips = casadi.vertcat(*planar_model.slip(x, robot))
    return {
        "torque": numeric([x, w, t], planar_model.motor_torque(x[6:10], w, t, robot)),
        "derivative": numeric([x, w, t], planar_model.derivative(x, w, t, robot)),
        "slip": numeric([x], slips),
    }


def split(values):
    values = np.array(values)
    return SCALE * values[:STATES], 80.0 * values[STATES : STATES + 4], 3.0 * values[STATES + 4 :]


def state(vx=0.0, vy=0.0, yaw_rate=0.0, wheels=0.0, heading=0.0):
    return np.array([0.0, 0.0, heading, vx, vy, yaw_rate, *np.broadcast_to(wheels, 4)])


@given(values=VALUES)
def test_motors_are_a_speed_loop_within_voltage_and_current(functions, robot, values):
    x, w, t = split(values)
    k, r = robot.torque_constant, robot.resistance
    wanted = robot.servo_gain * (w - x[6:]) + t
    # The voltage that this torque takes, limited; then the current.
    voltage = np.clip(wanted * r / k + k * x[6:], -robot.voltage, robot.voltage)
    by_hand = np.clip(k * (voltage - k * x[6:]) / r, -robot.torque_limit, robot.torque_limit)
    np.testing.assert_allclose(functions["torque"](x, w, t), by_hand, atol=1e-9)


def test_motors_are_mujocos(functions):
    model = scene.compose(1).compile()
    data, random = mujoco.MjData(model), np.random.default_rng(0)
    for _ in range(300):
        wheels, w, t = random.uniform(-110, 110, 4), random.uniform(-150, 150, 4), random.uniform(-3, 3, 4)
        if random.random() < 0.5:
            w = wheels + random.uniform(-5, 5, 4)  # within the limits
        data.qvel[6:10], data.ctrl[0::2], data.ctrl[1::2] = wheels, w, t
        mujoco.mj_forward(model, data)
        np.testing.assert_allclose(functions["torque"](state(wheels=wheels), w, t), data.actuator_force, atol=1e-9)


def test_slips_are_those_of_a_rigid_body(functions, robot):
    # On the spot to the left, wheels still: the left wheels' contacts move back, the front ones to the left.
    found = functions["slip"](state(yaw_rate=2.0))
    np.testing.assert_allclose(found[:4], 2.0 * robot.track / 2.0 * SIDES)
    np.testing.assert_allclose(found[4:], 2.0 * robot.wheelbase / 2.0 * np.array([1, 1, -1, -1]))
    rolling = functions["slip"](state(vx=2.0, wheels=2.0 / robot.wheel_radius))
    np.testing.assert_allclose(rolling, 0.0, atol=1e-12)


@pytest.mark.parametrize("speed", [-4.0, 0.0, 3.0])
def test_rolling_straight_on_it_stays_so(functions, robot, speed):
    wheels = speed / robot.wheel_radius
    # The motors carry the bearings' friction, by a little more than the wheels' speed.
    command = np.full(4, wheels * (1.0 + robot.wheel_damping / robot.servo_gain))
    rate = functions["derivative"](state(vx=speed, wheels=wheels, heading=0.5), command, np.zeros(4))
    np.testing.assert_allclose(rate[:2], speed * np.array([np.cos(0.5), np.sin(0.5)]))
    np.testing.assert_allclose(rate[2:], 0.0, atol=1e-9)


@given(values=VALUES)
def test_what_the_motors_give_goes_into_wheels_and_body(functions, robot, values):
    x, w, t = split(values)
    rate, torque = functions["derivative"](x, w, t), functions["torque"](x, w, t)
    push = (torque - robot.wheel_damping * x[6:] - robot.wheel_inertia * rate[6:]).sum() / robot.wheel_radius
    assert push == pytest.approx(robot.mass * (rate[3] - x[5] * x[4]), abs=1e-9)


@given(values=VALUES)
def test_tyres_take_the_energy_that_their_slip_dissipates(functions, robot, values):
    x, w, t = split(values)
    rate, torque = functions["derivative"](x, w, t), functions["torque"](x, w, t)
    gained = robot.mass * (x[3] * rate[3] + x[4] * rate[4]) + robot.yaw_inertia * x[5] * rate[5]
    gained += robot.wheel_inertia * x[6:] @ rate[6:]
    given_away = torque @ x[6:] - robot.wheel_damping * x[6:] @ x[6:] - gained
    # Under the weight of the vehicle at most, whoever carries it; never negative.
    slide = np.hypot(*functions["slip"](x).reshape(2, 4))
    assert -1e-9 <= given_away <= 2.0 * robot.friction * robot.mass * 9.81 * slide.max() + 1e-9


@given(values=VALUES)
def test_friction_is_coulombs_at_most(functions, robot, values):
    x, w, t = split(values)
    rate = functions["derivative"](x, w, t)
    force = robot.mass * np.array([rate[3] - x[5] * x[4], rate[4] + x[5] * x[3]])
    # The loads' shifts cancel in their sum as long as no tyre is unloaded, which at this height none is.
    assert np.hypot(*force) <= robot.friction * robot.mass * 9.81 * (1.0 + 1e-9)


@given(values=VALUES)
def test_left_and_right_are_alike(functions, values):
    x, w, t = split(values)
    side = [1, 0, 3, 2]
    mirror = np.array([1.0, -1.0, -1.0, 1.0, -1.0, -1.0])
    mirrored = np.concatenate([mirror * x[:6], x[6:][side]])
    rate = functions["derivative"](x, w, t)
    other = functions["derivative"](mirrored, w[side], t[side])
    np.testing.assert_allclose(other[:6], mirror * rate[:6], atol=1e-9)
    np.testing.assert_allclose(other[6:], rate[6:][side], atol=1e-9)


def test_places_and_headings_do_not_matter(functions):
    one = functions["derivative"](state(1.0, 0.3, 2.0, 15.0), np.full(4, 20.0), np.zeros(4))
    other = functions["derivative"](
        state(1.0, 0.3, 2.0, 15.0, heading=1.1) + np.eye(STATES)[0], np.full(4, 20.0), np.zeros(4)
    )
    np.testing.assert_allclose(other[2:], one[2:], atol=1e-12)


@pytest.mark.parametrize(
    ("duration", "speed", "difference", "torque", "rolling"),
    [
        pytest.param(1.0, 20.0, 0.0, 2.0, 0.0, id="launch"),
        pytest.param(1.2, 0.0, 0.0, 0.0, 5.0, id="brake"),
        pytest.param(1.0, 0.0, 20.0, 0.0, 0.0, id="turn in place"),
        pytest.param(1.0, 0.0, -40.0, 0.0, 0.0, id="turn in place, faster"),
        pytest.param(2.0, 20.0, 10.0, 0.0, 2.0, id="corner"),
        pytest.param(2.0, 40.0, 10.0, 0.0, 4.0, id="corner that slides"),
        pytest.param(1.5, 20.0, 20.0, 0.0, 2.0, id="corner into a spin"),
    ],
)
def test_it_drives_like_the_rigid_body(robot, duration, speed, difference, torque, rolling):
    ground, count = ProvingGround(scene.NOMINAL, 0.002), round(duration / PERIOD) - 1
    command = speed + difference / 2.0 * TURNING
    trace = ground.run(duration, command, torque, motion=(rolling, 0.0, 0.0))
    at = round(PERIOD / 0.002) * np.arange(1, count + 1)
    start = state(vx=rolling, wheels=rolling / ground.rolling_radius)
    found = planar_model.simulate(
        start, np.tile(np.broadcast_to(command, 4), (count, 1)), np.full((count, 4), torque), PERIOD, robot
    )
    pairs = {
        "velocity": (found[:, 3:5], trace.velocity_b[at, 0]),
        "yaw rate": (found[:, 5:6], trace.yaw_rate[at]),
        "wheels": (found[:, 6:], trace.wheel_speed[at, 0]),
        "place": (found[:, :2], trace.qpos[at, 0, :2]),
    }
    for name, (model, truth) in pairs.items():
        # Of each signal's range, which begins at rest: the least that its largest value can be called.
        error = np.sqrt(((model - truth) ** 2).sum(axis=-1).mean())
        assert error <= 0.1 * np.sqrt((truth**2).sum(axis=-1)).max() + 1e-6, name
