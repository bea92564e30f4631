"""Pictures of a trial, one by one, drawn by MuJoCo without a display."""

import contextlib
from collections.abc import Iterator

import mujoco
import numpy as np

from dynabot_mj.common.arrays import Progress
from dynabot_mj.film.camera import Rig, View
from dynabot_mj.film.overlays import Overlays, halo_radius
from dynabot_mj.film.pencil import Pencil
from dynabot_mj.film.shot import Shot
from dynabot_mj.film.strip import Numbers, Picture, Strip
from dynabot_mj.film.take import Take
from dynabot_mj.host import opengl
from dynabot_mj.viewing.stage import Stage

_MOST_GEOMS = 20_000
_BADGE_HEIGHT = 0.35  # above the ground [m]
_CIRCLE = np.stack([np.cos(np.arange(16) * np.pi / 8.0), np.sin(np.arange(16) * np.pi / 8.0)], axis=-1)
_CROSS = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
_WIDEST_ROOM = 4.0  # around each robot for what is believed of it [m]


class Film:
    """Draws the frames of a take; open one with `opened`."""

    def __init__(self, what: Take, shot: Shot) -> None:
        """Takes a current OpenGL context for granted."""
        one = what.recording
        self.take, self.shot = what, shot
        self._stage = Stage(one.setup, one.case, signs=False)
        model = self._stage.model
        model.vis.global_.offwidth, model.vis.global_.offheight = shot.width, shot.scene_height
        model.vis.quality.offsamples = shot.samples
        self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._scene = mujoco.MjvScene(model, maxgeom=_MOST_GEOMS)
        self._options, self._camera = mujoco.MjvOption(), mujoco.MjvCamera()
        self._viewport = mujoco.MjrRect(0, 0, shot.width, shot.scene_height)
        self._read = np.empty((shot.scene_height, shot.width, 3), dtype=np.uint8)
        self._overlays = Overlays(what, shot, self._stage.rings)
        self._strip = Strip(what, shot) if "strip" in shot.overlays else None
        self._numbers = Numbers(one.setup.robots, shot.height) if "marks" in shot.overlays else None
        self._rig = Rig(shot, float(model.vis.global_.fovy), one.position_w)
        # Beliefs jump about, and a camera that held them would as well: so there is room around the robots for them.
        spread = np.sqrt(np.nan_to_num(one.covariance[..., [0, 1], [0, 1]]).max())
        self._room = min(_WIDEST_ROOM, 1.5 * float(spread)) * _CROSS
        self._ring_w = self._stage.rings[-1][0] * _CIRCLE

    def view(self, k: int) -> View:
        """Returns where the camera is in a frame."""
        around_w = self.take.recording.position_w[k][:, None] + self._room
        held_w = [around_w.reshape(-1, 2), self._ring_w]
        if self.take.beside is not None:
            held_w.append(self.take.beside.position_w[k])
        ground_w = np.concatenate(held_w)
        return self._rig.view(k, np.concatenate([ground_w, np.zeros((len(ground_w), 1))], axis=1))

    def frame(self, k: int) -> Picture:
        """Returns a frame, (height, width, 3), in memory of its own."""
        view, model, data = self.view(k), self._stage.model, self._stage.data
        self._stage.place(self.take.snapshots[k])
        self._camera.lookat[:], self._camera.distance = view.lookat_w, view.distance
        self._camera.azimuth, self._camera.elevation = view.azimuth, view.elevation
        every = mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateScene(model, data, self._options, None, self._camera, every, self._scene)
        self._overlays.draw(k, view, Pencil(self._scene))
        mujoco.mjr_render(self._viewport, self._scene, self._context)
        mujoco.mjr_readPixels(self._read, None, self._viewport, self._context)
        picture = np.empty((self.shot.height, self.shot.width, 3), dtype=np.uint8)
        scene = picture[: self.shot.scene_height]
        scene[:] = self._read[::-1]  # OpenGL counts rows from below
        if self._numbers is not None:
            position_w = self.take.recording.position_w[k]
            raised = np.concatenate([position_w, np.full((len(position_w), 1), _BADGE_HEIGHT)], axis=-1)
            places, depth = view.project(raised)
            tilt = -np.sin(np.radians(view.elevation))
            places[:, 1] += tilt * halo_radius(view) / (view.slope_y * depth)  # not on the robot
            self._numbers.draw(scene, np.where(depth[:, None] > 0.0, places, np.nan))
        if self._strip is not None:
            picture[self.shot.scene_height :] = self._strip.draw(k)
        return picture

    def frames(self, progress: Progress = lambda share: None) -> Iterator[Picture]:
        """Yields all frames, one drawn after the other has been taken."""
        for k in range(self.take.frames):
            yield self.frame(k)
            progress((k + 1) / self.take.frames)

    def free(self) -> None:
        """Frees what OpenGL holds."""
        self._context.free()


@contextlib.contextmanager
def opened(what: Take, shot: Shot) -> Iterator[Film]:
    """Yields a film to draw frames of.

    Raises:
        GraphicsError: If nothing can be drawn here.
    """
    with opengl.context(shot.width, shot.scene_height):
        film = Film(what, shot)
        try:
            yield film
        finally:
            film.free()
