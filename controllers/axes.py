"""A robot's axes in the plane, and plane vectors as the local laws have them: components first, (2, ...).

So what is done to vectors is done to whole components of one shape. With (..., 2), numbers per robot would have to be
broadcast against pairs, and pairs summed over an axis of two: NumPy takes longer for that than for the arithmetic.
"""

from typing import NamedTuple

import numpy as np

from dynabot_mj.controllers.arrays import Array


class Axes(NamedTuple):
    """Unit vectors of a robot in the world."""

    forward_w: Array  # e_x, (2, ...)
    left_w: Array  # e_y, (2, ...)


def of_heading(heading: Array) -> Axes:
    """Returns the axes of robots that head somewhere, (...) [rad]."""
    cos, sin = np.cos(heading), np.sin(heading)
    return Axes(np.array((cos, sin)), np.array((-sin, cos)))


def components_first(vector: Array) -> Array:
    """Returns vectors (..., 2) as (2, ...)."""
    return np.array((vector[..., 0], vector[..., 1]))


def components_last(vector: Array) -> Array:
    """Returns vectors (2, ...), or with another number of components, as (..., 2)."""
    return vector.transpose(*range(1, vector.ndim), 0)


def dot(a: Array, b: Array) -> Array:
    """Returns the scalar products of vectors (2, ...), (...)."""
    products = a * b
    total: Array = products[0] + products[1]
    return total
