import numpy as np
import pytest

from dynabot_mj.controllers import axes

HEADING = np.array([[0.0, 0.5, -2.0], [np.pi, 7.0, -0.1]])


def test_axes_are_ahead_and_to_the_left():
    forward_w, left_w = axes.of_heading(HEADING)
    np.testing.assert_array_equal(forward_w, [np.cos(HEADING), np.sin(HEADING)])
    np.testing.assert_allclose(left_w, [np.cos(HEADING + np.pi / 2.0), np.sin(HEADING + np.pi / 2.0)], atol=1e-12)


def test_components_go_to_the_front_and_back_again():
    vectors = np.random.default_rng(0).normal(size=(4, 3, 2))
    first = axes.components_first(vectors)
    np.testing.assert_array_equal(first[:, 2, 1], vectors[2, 1])
    np.testing.assert_array_equal(axes.components_last(first), vectors)
    np.testing.assert_array_equal(axes.components_last(axes.components_first(vectors[0, 0])), vectors[0, 0])


def test_products_are_of_vectors():
    vectors = np.random.default_rng(1).normal(size=(2, 3, 2))
    products = axes.dot(*(axes.components_first(one) for one in vectors))
    assert products == pytest.approx([a @ b for a, b in zip(*vectors, strict=True)])
