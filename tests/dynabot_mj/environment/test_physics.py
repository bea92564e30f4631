import numpy as np
import pytest
from dm_control.mujoco import wrapper

from dynabot_mj.environment.physics import FleetPhysics
from dynabot_mj.plants import free_joint, scene
from dynabot_mj.study import configuration

HEADING = np.array([[1.0, 3.0]])
POSITION_W = np.array([[[1.0, 2.0], [-3.0, 4.0]]])


@pytest.fixture
def physics():
    setup = configuration.build({}, robots=2, plants=["rigid"])
    physics = FleetPhysics.from_model(wrapper.MjModel(scene.compose(2).compile()))
    physics.equip(setup, 0.156)
    with physics.reset_context():
        physics.place(POSITION_W, HEADING)
    return physics


def test_robots_are_where_they_were_placed_and_stay_there(physics):
    np.testing.assert_allclose(physics.state.heading, HEADING)
    physics.command_wheels(np.zeros((1, 2, 4)))
    physics.step(4 * physics.steps)
    np.testing.assert_allclose(physics.state.position_w, POSITION_W, atol=1e-3)
    assert physics.state.time == pytest.approx(0.156)
    assert physics.data.time == pytest.approx(0.156)


def test_the_state_is_that_of_the_quaternion(physics):
    physics.command_wheels(np.array([[[-20.0, 20.0, -20.0, 20.0]] * 2]))
    for _ in range(10):
        physics.step(4 * physics.steps)
    pose, motion = physics.data.qpos.reshape(1, 2, -1), physics.data.qvel.reshape(1, 2, -1)
    orientation = free_joint.orientation(np.moveaxis(pose[..., 3:7], -1, 0))
    turned = physics.state.heading - HEADING
    assert turned.min() > 0.5
    np.testing.assert_allclose(np.exp(1j * physics.state.heading), np.exp(1j * orientation.yaw), atol=1e-12)
    np.testing.assert_allclose(
        physics.state.yaw_rate, orientation.yaw_rate(np.moveaxis(motion[..., 3:6], -1, 0)), atol=1e-12
    )
    # Past half a turn, where the yaw jumps and the heading does not.
    assert physics.state.heading[0, 1] > np.pi


def test_forces_are_followed_until_wheels_are_commanded(physics):
    physics.command_force(np.array([[[20.0, 0.0], [0.0, 0.0]]]))
    physics.step(4 * physics.steps)
    assert np.abs(physics.data.ctrl.reshape(2, -1)[0]).max() > 0.0
    assert np.abs(physics.data.ctrl.reshape(2, -1)[1]).max() < 0.1
    physics.command_wheels(np.ones((1, 2, 4)))
    physics.step(4 * physics.steps)
    np.testing.assert_array_equal(physics.data.ctrl.reshape(2, 4, 2)[..., 0], 1.0)
    np.testing.assert_array_equal(physics.data.ctrl.reshape(2, 4, 2)[..., 1], 0.0)


def test_touching_is_told_until_the_next_command(physics):
    physics.place(np.array([[[0.0, 0.0], [0.0, 0.4]]]), np.zeros((1, 2)))
    physics.command_wheels(np.zeros((1, 2, 4)))
    assert not physics.touched
    physics.step(4 * physics.steps)
    assert physics.touched
    physics.command_wheels(np.zeros((1, 2, 4)))
    assert not physics.touched
