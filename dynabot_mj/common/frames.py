"""Plane vectors in the world's axes and in a robot's own, ahead and to the left."""

import numpy as np

from dynabot_mj.common.arrays import Array


def to_body(vector_w: Array, heading: Array) -> Array:
    """Returns a vector of the world in body axes.

    Args:
        vector_w: Any unit, (..., 2).
        heading: Of the body, (...) [rad].

    Returns:
        (..., 2), ahead and to the left.
    """
    cos, sin = np.cos(heading), np.sin(heading)
    x, y = vector_w[..., 0], vector_w[..., 1]
    return np.stack([cos * x + sin * y, cos * y - sin * x], axis=-1)


def to_world(vector_b: Array, heading: Array) -> Array:
    """Returns a vector in body axes, (..., 2), in those of the world; see `to_body`."""
    return to_body(vector_b, -heading)


def along(vector_w: Array, heading: Array) -> Array:
    """Returns the part of a vector, (..., 2), that is ahead of a body, (...); see `to_body`."""
    return vector_w[..., 0] * np.cos(heading) + vector_w[..., 1] * np.sin(heading)
