"""Drawing shapes into a MuJoCo scene, beside those of its model."""

import itertools
from collections.abc import Sequence

import mujoco
import numpy as np

from dynabot_mj.common.arrays import Array

RGBA = tuple[float, float, float, float]

_ORIGIN, _UPRIGHT = np.zeros(3), np.eye(3).ravel()
_CIRCLE = 2.0 * np.pi * np.arange(49) / 48


class Pencil:
    """Adds geoms to a scene until it is full."""

    def __init__(self, scene: mujoco.MjvScene) -> None:
        """Draws after what is in the scene already."""
        self._scene = scene

    def line(self, start_w: Array, end_w: Array, colour: RGBA, width: float = 2.0) -> None:
        """Draws a straight line between two points, (3,) [m], as wide on the picture as told [pixels]."""
        self._connect(mujoco.mjtGeom.mjGEOM_LINE, start_w, end_w, colour, width)

    def path(self, points_w: Array, colour: RGBA, width: float = 2.0) -> None:
        """Draws lines from point to point, (P, 3) [m]."""
        for start_w, end_w in itertools.pairwise(points_w):
            self.line(start_w, end_w, colour, width)

    def ellipse(self, centre_w: Array, axes: Array, colour: RGBA, width: float = 2.0) -> None:
        """Draws an ellipse around a centre, (3,) [m], whose half axes are the columns of a (2, 2) matrix [m]."""
        points_w = np.tile(centre_w, (len(_CIRCLE), 1))
        points_w[:, :2] += np.stack([np.cos(_CIRCLE), np.sin(_CIRCLE)], axis=-1) @ axes.T
        self.path(points_w, colour, width)

    def arrow(self, start_w: Array, end_w: Array, colour: RGBA, radius: float) -> None:
        """Draws an arrow between two points, (3,) [m], with a shaft of a radius [m]."""
        self._connect(mujoco.mjtGeom.mjGEOM_ARROW, start_w, end_w, colour, radius)

    def ball(self, centre_w: Array, radius: float, colour: RGBA) -> None:
        """Draws a sphere around a point, (3,) [m]."""
        self._shape(mujoco.mjtGeom.mjGEOM_SPHERE, (radius, 0.0, 0.0), centre_w, _UPRIGHT, colour)

    def disc(self, centre_w: Array, radius: float, colour: RGBA) -> None:
        """Draws a flat, level disc around a point, (3,) [m]."""
        self._shape(mujoco.mjtGeom.mjGEOM_CYLINDER, (radius, 1e-3, 0.0), centre_w, _UPRIGHT, colour)

    def box(self, centre_w: Array, half: Sequence[float], heading: float, colour: RGBA) -> None:
        """Draws a box with half edges (3,) [m] around a point, (3,) [m], turned by a heading [rad]."""
        c, s = np.cos(heading), np.sin(heading)
        turned = np.array([c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0])
        self._shape(mujoco.mjtGeom.mjGEOM_BOX, half, centre_w, turned, colour)

    def _connect(self, kind: mujoco.mjtGeom, start_w: Array, end_w: Array, colour: RGBA, width: float) -> None:
        geom = self._new(kind, _ORIGIN, _ORIGIN, _UPRIGHT, colour)
        if geom is not None:
            mujoco.mjv_connector(geom, kind, width, start_w, end_w)

    def _shape(
        self, kind: mujoco.mjtGeom, size: Sequence[float], centre_w: Array, rotation: Array, colour: RGBA
    ) -> None:
        self._new(kind, np.asarray(size, dtype=np.float64), centre_w, rotation, colour)

    def _new(
        self, kind: mujoco.mjtGeom, size: Array, centre_w: Array, rotation: Array, colour: RGBA
    ) -> mujoco.MjvGeom | None:
        scene = self._scene
        if scene.ngeom == scene.maxgeom:
            return None
        geom = scene.geoms[scene.ngeom]
        mujoco.mjv_initGeom(geom, kind, size, centre_w, rotation, np.asarray(colour, dtype=np.float32))
        scene.ngeom += 1
        return geom
