"""Where the camera is: pictures that hold all robots, from a distance that follows from where they are."""

import math
from dataclasses import dataclass

import numpy as np

from dynabot_mj.common.arrays import Array
from dynabot_mj.film.shot import Shot
from dynabot_mj.formation.leader import LEADER_W

_MARGIN = 1.12  # of a frame around what it has to hold
_CENTRINGS = 4  # rounds; more move nothing by as much as a pixel
_NEAREST = 5.0  # distance of a camera that holds all [m]
_ELEVATION = -27.0  # of an orbit [deg]
# Azimuth of an orbit at first [deg], and what it turns by [deg] per second of film. Robots start left of the
# leader: the way between them fills the width of the picture.
_START, _REVOLUTION = 78.0, 1.5
_CHASE_DISTANCE, _CHASE_ELEVATION, _CHASE_AHEAD = 3.2, -18.0, 0.6  # [m], [deg]; before the robot [m]
_CHASE_LAG = 0.8  # by which the camera's azimuth follows the leader's, seen from the robot [s of film]


@dataclass(frozen=True, kw_only=True)
class View:
    """A camera as MuJoCo's free camera has it, and its lens."""

    lookat_w: Array  # (3,) in the picture's middle [m]
    distance: float  # from there [m]
    azimuth: float  # [deg]
    elevation: float  # [deg]; negative: from above
    slope_x: float  # half the picture's width at a distance of 1
    slope_y: float

    def project(self, points_w: Array) -> tuple[Array, Array]:
        """Returns where points (..., 3) [m] are in the picture.

        Returns:
            Right and up, (..., 2), each from -1 to 1 within the picture, and their depths, (...) [m].
        """
        right, up, forward = _axes(self.azimuth, self.elevation)
        offset = points_w - self.lookat_w
        depth = offset @ forward + self.distance
        return np.stack([offset @ right / self.slope_x, offset @ up / self.slope_y], axis=-1) / depth[..., None], depth


def lens(shot: Shot, fovy: float) -> tuple[float, float]:
    """Returns half the width and half the height of the picture at a distance of 1; `fovy` is vertical [deg]."""
    slope = math.tan(math.radians(fovy) / 2.0)
    return slope * shot.width / shot.scene_height, slope


def framing(points_w: Array, azimuth: float, elevation: float, slopes: tuple[float, float]) -> View:
    """Returns a view from a direction that holds all points, (P, 3) [m], with a margin around them.

    It is aimed at the middle of what it holds, and as near as that allows: one of them is at the margin.
    """
    right, up, forward = _axes(azimuth, elevation)
    ahead = np.array([math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth)), 0.0])
    lookat_w, distance = np.zeros(3), 0.0
    for _ in range(_CENTRINGS):  # what is near is larger, so the middle of the ground is not that of the picture
        offset = points_w - lookat_w
        depth = offset @ forward + distance
        scale = distance / depth if distance else np.ones(len(points_w))
        for axis, shift, tilt in ((right, right, 1.0), (up, ahead, float(up @ ahead))):
            seen = (offset @ axis) * scale
            lookat_w = lookat_w + (0.5 * (float(seen.min()) + float(seen.max())) / tilt) * shift
        offset = points_w - lookat_w
        # A point is in the picture where |offset along an axis| <= slope * depth, depth = distance + offset forward.
        needed = [_MARGIN * np.abs(offset @ axis) / slope for axis, slope in zip((right, up), slopes, strict=True)]
        distance = max(_NEAREST, float((np.maximum(*needed) - offset @ forward).max()))
    return View(
        lookat_w=lookat_w,
        distance=distance,
        azimuth=azimuth,
        elevation=elevation,
        slope_x=slopes[0],
        slope_y=slopes[1],
    )


def chase(position_w: Array, azimuth: float, slopes: tuple[float, float]) -> View:
    """Returns the view over a robot, (2,) [m], along an azimuth [deg]."""
    angle = math.radians(azimuth)
    ahead = position_w + _CHASE_AHEAD * np.array([math.cos(angle), math.sin(angle)])
    return View(
        lookat_w=np.array([*ahead, 0.2]),
        distance=_CHASE_DISTANCE,
        azimuth=azimuth,
        elevation=_CHASE_ELEVATION,
        slope_x=slopes[0],
        slope_y=slopes[1],
    )


class Rig:
    """A camera that moves as the shot has it."""

    def __init__(self, shot: Shot, fovy: float, position_w: Array) -> None:
        """Takes the way of the robot that it may have to follow.

        Args:
            shot: Which camera.
            fovy: Vertical field of view [deg].
            position_w: Of the robots, (K, n, 2) [m].
        """
        self._shot, self._slopes = shot, lens(shot, fovy)
        self._followed_w = position_w[:, shot.follow]
        # Over the robot toward the leader, not along its heading: a robot at rest may turn its back on all others.
        offset_w = LEADER_W - self._followed_w
        bearing = np.unwrap(np.arctan2(offset_w[:, 1], offset_w[:, 0]))
        self._azimuth = np.degrees(_followed(bearing, 1.0 / (shot.rate * _CHASE_LAG)))

    def view(self, k: int, held_w: Array) -> View:
        """Returns the view of frame k; the picture holds the points (P, 3) [m], about which `chase` does not care."""
        match self._shot.camera:
            case "top":
                return framing(held_w, 90.0, -90.0, self._slopes)
            case "orbit":
                return framing(held_w, _START + _REVOLUTION * k / self._shot.rate, _ELEVATION, self._slopes)
            case "chase":
                return chase(self._followed_w[k], float(self._azimuth[k]), self._slopes)


def _followed(values: Array, share: float) -> Array:
    """Returns values, (K,), that follow the given ones by a share of what is between them in each step."""
    followed = np.empty_like(values)
    current = float(values[0])
    for k, value in enumerate(values):
        current += min(1.0, share) * (float(value) - current)
        followed[k] = current
    return followed


def _axes(azimuth: float, elevation: float) -> tuple[Array, Array, Array]:
    """Returns the directions to the right of, up in and into the picture, (3,) each."""
    a, e = math.radians(azimuth), math.radians(elevation)
    forward = np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])
    right = np.array([math.sin(a), -math.cos(a), 0.0])
    return right, np.cross(right, forward), forward
