"""A trial in the browser, by mjviser and viser: the robots, their trails, and a panel with time, speed and centre."""

import socket
from collections.abc import Sequence
from typing import Any

import numpy as np
import rich
import viser
from mjviser import ViserMujocoScene

from dynabot_mj.common.arrays import Array
from dynabot_mj.common.exceptions import DynabotError
from dynabot_mj.common.legend import ROBOT_COLOURS, rgb
from dynabot_mj.viewing import stage
from dynabot_mj.viewing.playback import Clock
from dynabot_mj.viewing.stage import Snapshot, Stage

_CAMERA = (-7.0, -7.0, 5.0)  # relative to what is centred [m]
_TRAIL_HEIGHT = 0.015  # above the floor and the rings [m]
_FASTEST, _SLOWEST = 100.0, 0.05  # speeds that the panel allows
_CENTRES = ("robots", "leader")


class Browser:
    """A server that shows a stage to all who load its page."""

    open = True  # until the command is interrupted

    def __init__(self, what: Stage, clock: Clock, *, title: str, duration: float, host: str, port: int) -> None:
        """Starts to serve.

        Args:
            what: That is shown.
            clock: That the panel sets.
            title: Of the panel.
            duration: Of the trial [s].
            host: Address that is listened on.
            port: Of TCP; 0: any free one.

        Raises:
            DynabotError: If it cannot be listened on.
        """
        _require_free(host, port)
        rich.get_console().quiet = True  # viser tells what it does there
        self._stage, self._clock = what, clock
        self._server: Any = viser.ViserServer(host=host, port=port, label=title, verbose=False)
        self.address = f"http://{f'[{host}]' if ':' in host else host}:{self._server.get_port()}"
        # viser can pass a page on through a server of its makers: nobody outside is to see it by a click.
        self._server.gui.configure_theme(show_share_button=False, show_logo=False)
        self._server.initial_camera.position = _CAMERA
        self._server.initial_camera.look_at = (0.0, 0.0, 0.0)
        self._moved = [self._server.scene.add_frame(name, show_axes=False) for name in ("/bodies", "/trails")]
        self._scene = ViserMujocoScene(self._server, what.model, num_envs=1)
        self._scene.camera_tracking_enabled = False  # that is of one body; ours are the panel's centres
        self._moved.append(self._scene.fixed_bodies_frame)
        self._trails: list[Any] = []
        self._shown: Snapshot | None = None
        self._add_panel(duration)

    def show(self, snapshots: Sequence[Snapshot], index: int) -> None:
        """Shows one of the snapshots, and where the robots have been before."""
        self._button.label = "Pause" if self._clock.playing else "Play"
        snapshot = snapshots[index]
        if snapshot is self._shown:
            return
        self._shown = snapshot
        self._stage.place(snapshot)
        centre = -snapshot.position_w.mean(axis=0) if self._centre.value == "robots" else np.zeros(2)
        with self._server.atomic():
            self._scene.update_from_mjdata(self._stage.data)
            for frame in self._moved:
                frame.position = (*centre, 0.0)
            self._draw(stage.trail(snapshots, index))
            self._slider.value = round(snapshot.time, 2)

    def settle(self) -> None:
        """Lets any time be chosen."""
        self._slider.disabled = False

    def close(self) -> None:
        """Stops to serve."""
        self._server.stop()

    def _add_panel(self, duration: float) -> None:
        gui = self._server.gui
        dots = (
            f"<span style='color: {colour}'>&#9679;</span> robot {robot + 1}&emsp;"
            for robot, colour in enumerate(ROBOT_COLOURS[: self._stage.robots])
        )
        gui.add_html(f"<div style='padding: 0 1em 0.5em; font-size: 0.85em'>{''.join(dots)}</div>")
        self._slider = gui.add_slider("time [s]", min=0.0, max=duration, step=0.01, initial_value=0.0, disabled=True)
        self._button = gui.add_button("Pause")
        self._speed = gui.add_number("speed", initial_value=self._clock.speed, min=_SLOWEST, max=_FASTEST, step=0.05)
        self._centre = gui.add_dropdown("centre", _CENTRES, initial_value=_CENTRES[0])
        self._slider.on_update(self._choose_time)
        self._button.on_click(self._toggle)
        self._speed.on_update(self._choose_speed)
        self._centre.on_update(self._choose_centre)

    def _choose_time(self, event: Any) -> None:
        if event.client is not None:  # a hand, not `show`
            self._clock.time = self._slider.value

    def _toggle(self, event: Any) -> None:
        self._clock.playing = not self._clock.playing

    def _choose_speed(self, event: Any) -> None:
        self._clock.speed = self._speed.value

    def _choose_centre(self, event: Any) -> None:
        self._shown = None  # to be shown again

    def _draw(self, trails_w: Array) -> None:
        """Draws the robots' trails, (n, P, 2) [m], as lines from point to point."""
        raised = np.concatenate([trails_w, np.full((*trails_w.shape[:2], 1), _TRAIL_HEIGHT)], axis=-1)
        ends = np.stack([raised[:, :-1], raised[:, 1:]], axis=2).astype(np.float32)  # (n, P - 1, 2, 3)
        for robot, segments in enumerate(ends):
            if robot < len(self._trails):
                self._trails[robot].points = segments
            elif len(segments):
                line = self._server.scene.add_line_segments(
                    f"/trails/{robot}", segments, rgb(ROBOT_COLOURS[robot]), thickness=0.03
                )
                self._trails.append(line)


def _require_free(host: str, port: int) -> None:
    """Makes sure that it can be listened on: viser would take another port, or wait for ever.

    Raises:
        DynabotError: If it cannot.
    """
    try:
        family, kind, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        with socket.socket(family, kind) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(address)
    except OSError as error:
        raise DynabotError(f"cannot listen on {host}, port {port}: {error.strerror}") from error
