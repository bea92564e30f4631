"""A chassis' orientation, its planar part, and what accelerometers on it feel.

MuJoCo gives a free joint's orientation as a quaternion, its linear velocity in the world's axes and its angular
velocity in the body's. Components stand first here, since they are taken one by one: vectors are (3, ...).
"""

from typing import NamedTuple

import numpy as np

from dynabot_mj.common.arrays import Array


class Orientation(NamedTuple):
    """Body axes of chassis, ahead and to the left, in the world; and the world's vertical in the body."""

    horizontal_w: Array  # (2, 3, ...)
    vertical_b: tuple[Array, Array, Array]  # each (...)

    @property
    def yaw(self) -> Array:
        """Heading from the world's x axis, wrapped, (...) [rad]."""
        return np.arctan2(self.horizontal_w[0, 1], self.horizontal_w[0, 0])

    def yaw_rate(self, spin_b: Array) -> Array:
        """Returns the angular velocity about the vertical, (...) [rad/s].

        Args:
            spin_b: Angular velocity, (3, ...) [rad/s].
        """
        return self.vertical_b[0] * spin_b[0] + self.vertical_b[1] * spin_b[1] + self.vertical_b[2] * spin_b[2]


def orientation(quaternion: Array) -> Orientation:
    """Returns the axes that a rotation into the world means.

    Args:
        quaternion: Its components w, x, y, z, (4, ...).
    """
    w, x, y, z = quaternion
    xy, wz = x * y, w * z
    xx, yy, zz = x * x, y * y, z * z
    vertical_b = (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (xx + yy))
    ahead = (1.0 - 2.0 * (yy + zz), 2.0 * (wz + xy), vertical_b[0])
    left = (2.0 * (xy - wz), 1.0 - 2.0 * (xx + zz), vertical_b[1])
    return Orientation(np.array((ahead, left)), vertical_b)


def felt_increment_b(axes_w: Array, change_w: Array, interval: float, gravity_w: Array) -> Array:
    """Returns by how much the integrals of accelerometers ahead and to the left grow, (2, ...) [m/s].

    They feel the specific force, acceleration less gravity. Within the interval, during which the velocity alone is
    known, the axes are held.

    Args:
        axes_w: The accelerometers' axes in the interval, the mean of those at its ends, (2, 3, ...).
        change_w: Of the velocity, (3, ...) [m/s].
        interval: Its length [s].
        gravity_w: Its acceleration, of a shape that goes with the change's, (3, ...) [m/s^2].
    """
    return (axes_w * (change_w - interval * gravity_w)).sum(axis=1)


def place(
    qpos: Array, position_w: Array, heading: Array, height: float, orientation: tuple[float, float, float, float]
) -> None:
    """Puts robots on the ground, all standing alike but for their headings.

    Args:
        qpos: Their coordinates, the free joint's first, (..., 7 or more); changed in place.
        position_w: Of their centres, (..., 2) [m].
        heading: (...) [rad].
        height: Of the chassis [m].
        orientation: Of the chassis with heading zero, a quaternion.
    """
    qpos[..., :2] = position_w
    qpos[..., 2] = height
    qpos[..., 3:7] = turned(heading, np.array(orientation))


def continued(heading: Array, yaw: Array) -> Array:
    """Returns the angle that means a yaw and is within half a turn of the heading before, (...) [rad]."""
    return heading + (yaw - heading + np.pi) % (2.0 * np.pi) - np.pi


def turned(heading: Array, quaternion: Array) -> Array:
    """Returns an orientation turned about the world's z axis.

    Args:
        heading: By which it is turned, (...) [rad].
        quaternion: The orientation, (4,).

    Returns:
        The quaternions, as MuJoCo has them, (..., 4).
    """
    cos, sin = np.cos(heading / 2.0), np.sin(heading / 2.0)
    w, x, y, z = quaternion
    return np.stack([cos * w - sin * z, cos * x - sin * y, cos * y + sin * x, cos * z + sin * w], axis=-1)
