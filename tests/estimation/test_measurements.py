import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynabot_mj.estimation.measurements import rotation, wrap


def test_rotation_turns_to_the_left():
    np.testing.assert_allclose(rotation(np.array(np.pi / 2)) @ [1.0, 0.0], [0.0, 1.0], atol=1e-15)


def test_rotation_broadcasts_over_leading_axes():
    angles = np.linspace(-3.0, 3.0, 6).reshape(2, 3)
    matrices = rotation(angles)
    assert matrices.shape == (2, 3, 2, 2)
    np.testing.assert_allclose(matrices[1, 2], [[np.cos(3.0), -np.sin(3.0)], [np.sin(3.0), np.cos(3.0)]])


@given(st.floats(-100.0, 100.0))
def test_wrapped_angles_point_the_same_way(angle):
    wrapped = wrap(np.array(angle))
    assert -np.pi <= wrapped < np.pi
    np.testing.assert_allclose(rotation(wrapped), rotation(np.array(angle)), atol=1e-12)


@pytest.mark.parametrize(("angle", "wrapped"), [(np.pi + 0.1, 0.1 - np.pi), (-np.pi, -np.pi), (np.pi, -np.pi)])
def test_wrap_at_its_ends(angle, wrapped):
    assert wrap(np.array(angle)) == pytest.approx(wrapped, abs=1e-12)
