import numpy as np
import pytest

from dynabot_mj.common.frames import along, to_body, to_world


def test_a_robot_that_faces_north_has_east_to_its_right():
    np.testing.assert_allclose(to_body(np.array([1.0, 0.0]), np.array(np.pi / 2.0)), [0.0, -1.0], atol=1e-15)


def test_there_and_back_is_the_same():
    random = np.random.default_rng(0)
    vector, heading = random.normal(size=(5, 3, 2)), random.uniform(-10.0, 10.0, (5, 3))
    np.testing.assert_allclose(to_world(to_body(vector, heading), heading), vector, atol=1e-14)


def test_along_is_the_forward_speed():
    assert along(np.array([3.0, 4.0]), np.array(np.pi / 2.0)) == pytest.approx(4.0)
