import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dynabot_mj.plants import free_joint

ROTATIONS = Rotation.from_rotvec(np.random.default_rng(0).normal(size=(20, 3)))
QUATERNIONS = ROTATIONS.as_quat(scalar_first=True).T


def test_axes_are_the_columns_of_the_rotation():
    orientation = free_joint.orientation(QUATERNIONS)
    matrix = ROTATIONS.as_matrix()
    np.testing.assert_allclose(
        np.moveaxis(orientation.horizontal_w, -1, 0), matrix[:, :, :2].swapaxes(1, 2), atol=1e-14
    )
    np.testing.assert_allclose(np.stack(orientation.vertical_b, axis=-1), matrix[:, 2], atol=1e-14)


def test_yaw_and_its_rate_are_about_the_vertical():
    orientation = free_joint.orientation(QUATERNIONS)
    np.testing.assert_allclose(orientation.yaw, ROTATIONS.as_euler("ZYX")[:, 0], atol=1e-12)
    spin_b = np.random.default_rng(1).normal(size=(3, 20))
    np.testing.assert_allclose(orientation.yaw_rate(spin_b), ROTATIONS.apply(spin_b.T)[:, 2], atol=1e-14)


def test_what_is_turned_keeps_its_tilt():
    heading = np.linspace(-3.0, 3.0, 7)
    tilt = Rotation.from_euler("ZYX", [0.0, 0.02, -0.03])
    turned = free_joint.turned(heading, tilt.as_quat(scalar_first=True))
    angles = Rotation.from_quat(turned, scalar_first=True).as_euler("ZYX")
    np.testing.assert_allclose(angles, [[yaw, 0.02, -0.03] for yaw in heading], atol=1e-14)


def test_at_rest_a_tilted_accelerometer_feels_gravity():
    pitch = 0.1  # nose down
    axes_w = free_joint.orientation(Rotation.from_euler("y", pitch).as_quat(scalar_first=True)).horizontal_w
    felt_b = free_joint.felt_increment_b(axes_w, np.zeros(3), 0.5, np.array([0.0, 0.0, -9.81]))
    assert felt_b == pytest.approx([-0.5 * 9.81 * np.sin(pitch), 0.0])


def test_in_free_fall_nothing_is_felt():
    gravity_w = np.array([0.0, 0.0, -9.81])
    axes_w = free_joint.orientation(QUATERNIONS[:, 0]).horizontal_w
    np.testing.assert_allclose(free_joint.felt_increment_b(axes_w, 0.2 * gravity_w, 0.2, gravity_w), 0.0, atol=1e-15)


def test_placed_robots_stand_where_they_are_put():
    qpos = np.full((2, 3, 11), 7.0)
    heading = np.linspace(-3.0, 3.0, 6).reshape(2, 3)
    free_joint.place(qpos, np.ones((2, 3, 2)), heading, 0.1, (1.0, 0.0, 0.0, 0.0))
    np.testing.assert_array_equal(qpos[..., :3], np.broadcast_to([1.0, 1.0, 0.1], (2, 3, 3)))
    np.testing.assert_allclose(free_joint.orientation(np.moveaxis(qpos[..., 3:7], -1, 0)).yaw, heading)
    assert (qpos[..., 7:] == 7.0).all()


def test_headings_continue_without_jumps():
    heading = np.array([3.0, -3.0, 20.0])
    turned = free_joint.continued(heading, np.arctan2(np.sin(heading + 0.5), np.cos(heading + 0.5)))
    np.testing.assert_allclose(turned, heading + 0.5)
