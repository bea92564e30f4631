"""A trial in MuJoCo's own window, where there is a display: space halts and continues, the arrows go back and ahead."""

import itertools
import warnings
from collections.abc import Sequence

import glfw
import mujoco
import numpy as np
from mujoco import viewer

from dynabot_mj.common.arrays import Array
from dynabot_mj.common.legend import ROBOT_COLOURS, rgb
from dynabot_mj.viewing import stage
from dynabot_mj.viewing.playback import Clock
from dynabot_mj.viewing.stage import Snapshot, Stage

_DISTANCE, _AZIMUTH, _ELEVATION = 10.0, 45.0, -28.0  # of the camera at first [m], [deg], [deg]
_LEAP = 1.0  # by which an arrow moves the clock [s]
_TRAIL_HEIGHT, _TRAIL_WIDTH = 0.015, 0.012  # above the floor and the rings; radius [m]


class Window:
    """MuJoCo's viewer, which draws in a thread of its own."""

    def __init__(self, what: Stage, clock: Clock) -> None:
        """Opens it."""
        self._stage, self._clock, self._settled = what, clock, False
        self._handle = viewer.launch_passive(
            what.model, what.data, key_callback=self._press, show_left_ui=False, show_right_ui=False
        )
        camera = self._handle.cam
        camera.distance, camera.azimuth, camera.elevation = _DISTANCE, _AZIMUTH, _ELEVATION

    @property
    def open(self) -> bool:
        """Whether it has not been closed."""
        return bool(self._handle.is_running())

    def show(self, snapshots: Sequence[Snapshot], index: int) -> None:
        """Shows one of the snapshots, and where the robots have been before."""
        snapshot = snapshots[index]
        with self._handle.lock():
            self._stage.place(snapshot)
            self._handle.cam.lookat[:2] = snapshot.position_w.mean(axis=0)
            _draw(self._handle.user_scn, stage.trail(snapshots, index))
        self._handle.sync()

    def settle(self) -> None:
        """Lets the arrows move the clock."""
        self._settled = True

    def close(self) -> None:
        """Closes it."""
        self._handle.close()

    def _press(self, key: int) -> None:
        if key == glfw.KEY_SPACE:
            self._clock.playing = not self._clock.playing
        elif self._settled and key in (glfw.KEY_LEFT, glfw.KEY_RIGHT):
            leap = _LEAP if key == glfw.KEY_RIGHT else -_LEAP
            self._clock.time = max(0.0, self._clock.time + leap)


def display_answers() -> bool:
    """Tells whether the display that the environment names can be opened."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", glfw.GLFWError)
        return bool(glfw.init())


def _draw(scene: mujoco.MjvScene, trails_w: Array) -> None:
    """Draws the robots' trails, (n, P, 2) [m], as rods from point to point, as far as the scene has room."""
    scene.ngeom = 0
    raised = np.concatenate([trails_w, np.full((*trails_w.shape[:2], 1), _TRAIL_HEIGHT)], axis=-1)
    for robot, points in enumerate(raised):
        colour = np.array([*rgb(ROBOT_COLOURS[robot]), 1.0])
        for start, end in itertools.pairwise(points):
            if scene.ngeom == scene.maxgeom:
                return
            rod, kind = scene.geoms[scene.ngeom], mujoco.mjtGeom.mjGEOM_CAPSULE
            mujoco.mjv_initGeom(rod, kind, np.zeros(3), np.zeros(3), np.zeros(9), colour)
            mujoco.mjv_connector(rod, kind, _TRAIL_WIDTH, start, end)
            scene.ngeom += 1
