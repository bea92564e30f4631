"""What is drawn over the scene: trails, beliefs, forces, messages, marks. The ground stays readable from far and near.

What has a meaning in metres (rings, grid, ellipses, hulls) is drawn to scale; what only has to be seen (halos, arrows,
heights above the ground) grows with the camera's distance.
"""

import math
from dataclasses import dataclass

import numpy as np

from dynabot_mj.common.arrays import Array
from dynabot_mj.common.legend import ROBOT_COLOURS, rgb
from dynabot_mj.film.camera import View
from dynabot_mj.film.pencil import RGBA, Pencil
from dynabot_mj.film.shot import Shot
from dynabot_mj.film.take import Take
from dynabot_mj.formation.leader import LEADER_W
from dynabot_mj.plants import scene
from dynabot_mj.plants.kinds import KINDS
from dynabot_mj.study import assembly, fleet
from dynabot_mj.viewing import stage

LOST_COLOUR: RGBA = (0.86, 0.05, 0.05, 1.0)  # and a cross half-way: not told by its colour alone

_GRID, _GRID_REACH = 10.0, 90.0  # between two lines, and how far they go at least [m]
_GRID_SHARE = 2.0  # of the camera's distance, how far they go
_GRID_COLOUR: RGBA = (0.62, 0.64, 0.64, 1.0)
_RING_POINTS = 120
_FORCE_COLOUR: RGBA = (0.42, 0.10, 0.55, 1.0)
_FORCE_HEIGHT = 0.2  # of arrows [m]
_FORCE_SCALE = 50.0  # for a robot whose force has no limit [N]
_SHADOWS = ((1.1, 0.13), (0.9, 0.25))  # sizes against the hull's, opacities
_SUN = np.array([-0.06, 0.045])  # where shadows fall, for what is as high as a robot [m]
_GHOST_OPACITY, _LINK_OPACITY = 0.38, 0.55
_FEW_LINKS = 6  # more of them are drawn more faintly, or they would hide all else
_ARRIVED, _LOST = 0.10, 0.5  # how long a message is shown that has arrived, or was lost [s]
_LONGEST_LATENCY = 1.0  # of messages that are looked for [s]; the longest that was seen is below 0.1 s
_FULL_FORCE, _HALO, _SHAFT, _LIFT, _LANE = 0.12, 0.011, 0.0035, 0.0006, 0.0035  # shares of the camera's distance
_SMALLEST_HALO = 0.45  # [m]
_LEADER_RADIUS = 0.2  # [m]
_RADIO_HEIGHT = 0.24  # of a robot's antenna [m]


@dataclass(frozen=True, kw_only=True)
class _Moment:
    """One frame's index, camera and pencil."""

    k: int
    view: View
    pencil: Pencil

    def lifted(self, points_w: Array, layer: float = 1.0) -> Array:
        """Returns points of the ground, (..., 2) [m], as (..., 3), so far above it that they are seen over it."""
        height = layer * (0.008 + _LIFT * self.view.distance)
        return np.concatenate([points_w, np.full((*points_w.shape[:-1], 1), height)], axis=-1)


def halo_radius(view: View) -> float:
    """Returns the radius of the ring around each robot [m], by which it is found from far as well."""
    return max(_SMALLEST_HALO, _HALO * view.distance)


class Overlays:
    """Draws all that a shot has over its scene."""

    def __init__(self, what: Take, shot: Shot, rings: tuple[tuple[float, RGBA], ...]) -> None:
        """Prepares what does not change.

        Args:
            what: The trial.
            shot: What is drawn of it.
            rings: Radii of the well's rings [m] and their colours.
        """
        self._take, self._shot = what, shot
        one = what.recording
        vehicle = scene.read_robot(fleet.conditions(one.setup)).vehicle
        self._hull = (vehicle.length / 2.0, vehicle.breadth / 2.0)
        self._radius = one.setup.collision_distance / 2.0  # of a point mass
        self._body = KINDS[one.case.plant].body
        links = one.setup.robots * (one.setup.robots - 1)
        self._link_opacity = _LINK_OPACITY * math.sqrt(_FEW_LINKS / max(links, _FEW_LINKS))
        limit = assembly.field(one.setup, one.case.estimator).force_limit
        self._full_force = limit if math.isfinite(limit) else _FORCE_SCALE
        angle = 2.0 * np.pi * np.arange(_RING_POINTS + 1) / _RING_POINTS
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        self._rings = [(radius * circle, colour) for radius, colour in rings]
        self._colours = [(*rgb(colour), 1.0) for colour in ROBOT_COLOURS]

    def draw(self, k: int, view: View, pencil: Pencil) -> None:
        """Draws the overlays of a frame."""
        now = _Moment(k=k, view=view, pencil=pencil)
        shown = self._shot.overlays
        self._ground(now)
        if "trails" in shown:
            self._trails(now)
        if "marks" in shown:
            self._marks(now)
        if "beliefs" in shown:
            self._beliefs(now)
        if "forces" in shown:
            self._forces(now)
        if "links" in shown:
            self._links(now)

    def _ground(self, now: _Moment) -> None:
        """Draws grid, rings, and shadows, which a shadow map would render with stripes all over such a ground."""
        count = math.ceil(max(_GRID_REACH, _GRID_SHARE * now.view.distance) / _GRID)
        reach = _GRID * count
        # Around what is looked at: lines that are too far to be seen cost time as well.
        middle = _GRID * np.round(now.view.lookat_w[:2] / _GRID)
        for line in _GRID * np.arange(-count, count + 1):
            ends = np.array([[-reach, line], [reach, line]])
            for points in (ends, ends[:, ::-1]):
                now.pencil.path(now.lifted(middle + points, 0.5), _GRID_COLOUR, 1.0)
        for points, colour in self._rings:
            now.pencil.path(now.lifted(points), colour, 3.0)
        one = self._take.recording
        now.pencil.disc(now.lifted(LEADER_W + _SUN, 0.6), _LEADER_RADIUS, (0, 0, 0, sum(x for _, x in _SHADOWS)))
        for place, heading in zip(one.position_w[now.k], one.heading[now.k], strict=True):
            for size, opacity in _SHADOWS:
                centre, colour = now.lifted(place + _SUN, 0.6), (0, 0, 0, opacity)
                if self._body:
                    now.pencil.box(centre, (size * self._hull[0], size * self._hull[1], 1e-3), heading, colour)
                else:
                    now.pencil.disc(centre, size * self._radius, colour)

    def _trails(self, now: _Moment) -> None:
        for robot, points in enumerate(stage.trail(self._take.snapshots, now.k)):
            now.pencil.path(now.lifted(points, 1.2), self._colours[robot], 2.0)
        if self._take.beside is not None:
            for robot, points in enumerate(stage.trail(self._take.beside_snapshots, now.k)):
                # Dashed: every other piece.
                raised = now.lifted(points, 1.2)
                for start, end in zip(raised[:-1:2], raised[1::2], strict=False):
                    now.pencil.line(start, end, self._colours[robot], 2.0)

    def _marks(self, now: _Moment) -> None:
        """Draws a halo around each robot, a thick red one where it has collided, and the point masses beside."""
        one, halo = self._take.recording, halo_radius(now.view)
        for robot, place in enumerate(one.position_w[now.k]):
            centre = now.lifted(place, 1.4)
            now.pencil.ellipse(centre, halo * np.eye(2), self._colours[robot], 2.0)
            if self._take.collided[now.k, robot]:
                for size in (1.25, 1.4, 1.55):
                    now.pencil.ellipse(centre, size * halo * np.eye(2), LOST_COLOUR, 3.0)
        if self._take.beside is not None:
            radius = max(self._radius, 0.5 * _HALO * now.view.distance)
            for robot, place in enumerate(self._take.beside.position_w[now.k]):
                now.pencil.ball(np.array([*place, radius]), radius, (*self._colours[robot][:3], 0.7))

    def _beliefs(self, now: _Moment) -> None:
        """Draws ghosts where robots believe to be, with one standard deviation; or what one robot believes of all."""
        one, k = self._take.recording, now.k
        if one.case.perception is not None:
            own = range(one.setup.robots) if self._shot.eyes_of is None else [self._shot.eyes_of]
            for robot in own:
                if np.isfinite(one.believed_w[k, robot]).all():
                    self._ghost(now, robot, one.believed_w[k, robot])
                    variances, directions = np.linalg.eigh(one.covariance[k, robot])
                    axes = directions * np.sqrt(np.maximum(variances, 0.0))
                    now.pencil.ellipse(now.lifted(one.believed_w[k, robot], 1.6), axes, self._colours[robot], 1.5)
        if (eyes := self._shot.eyes_of) is not None:
            for robot, heard_w in enumerate(one.heard_w[k, eyes]):
                if robot != eyes and np.isfinite(heard_w).all():
                    self._ghost(now, robot, heard_w)
                    ends = np.stack([heard_w, one.position_w[k, robot]])
                    now.pencil.path(now.lifted(ends, 1.6), self._colours[robot], 1.0)

    def _ghost(self, now: _Moment, robot: int, place_w: Array) -> None:
        """Draws a translucent robot; its heading is the true one, since only a position is believed."""
        colour = (*self._colours[robot][:3], _GHOST_OPACITY)
        if self._body:
            heading = self._take.recording.heading[now.k, robot]
            now.pencil.box(np.array([*place_w, 0.09]), (*self._hull, 0.07), heading, colour)
        else:
            now.pencil.ball(np.array([*place_w, self._radius]), self._radius, colour)

    def _forces(self, now: _Moment) -> None:
        """Draws commands as arrows from the hull's edge on; a full one is _FULL_FORCE of the camera's distance long."""
        one = self._take.recording
        for place, force_w in zip(one.position_w[now.k], one.force_w[now.k], strict=True):
            reach = force_w * (_FULL_FORCE * now.view.distance / self._full_force)
            length = float(np.hypot(*reach))
            if length > 3.0 * _SHAFT * now.view.distance:
                tail = place + reach * (self._radius / length)
                start_w, end_w = (np.array([*end, _FORCE_HEIGHT]) for end in (tail, tail + reach))
                now.pencil.arrow(start_w, end_w, _FORCE_COLOUR, _SHAFT * now.view.distance)

    def _links(self, now: _Moment) -> None:
        """Draws messages: as they arrive in their sender's colour, lost ones in red with a cross half-way.

        They are shown for a while of the film where it is slow, of the simulation where it is fast, and for a frame at
        least.
        """
        one, messages = self._take.recording, self._take.recording.messages
        time = float(one.time[now.k])
        arrived_for, lost_for = (max(self._shot.interval, x * min(1.0, self._shot.speed)) for x in (_ARRIVED, _LOST))
        earliest = time - max(arrived_for + _LONGEST_LATENCY, lost_for)
        recent = slice(*np.searchsorted(messages.sent_at, [earliest, time + 1e-9]))
        sent_at, senders = messages.sent_at[recent], messages.sender[recent]
        age = time - messages.arrives_at[recent]  # since the arrival; -inf where there is none
        arrived = (age >= 0.0) & (age < arrived_for)
        lost = messages.lost[recent] & (time - sent_at < lost_for)[:, None]
        place_w = one.position_w[now.k]
        # One line for each pair and direction, red if anything of it was lost.
        pairs = {(int(senders[m]), int(receiver)): False for m, receiver in np.argwhere(arrived)}
        pairs |= {(int(senders[m]), int(receiver)): True for m, receiver in np.argwhere(lost)}
        for (sender, receiver), is_lost in sorted(pairs.items()):
            self._link(now, place_w[sender], place_w[receiver], self._colours[sender], is_lost)

    def _link(self, now: _Moment, start_w: Array, end_w: Array, colour: RGBA, lost: bool) -> None:
        """Draws a message beside the line between two robots, so that those of both directions are seen."""
        way = end_w - start_w
        length = float(np.hypot(*way))
        if length < 1e-6:
            return
        ahead, aside = way / length, np.array([-way[1], way[0]]) / length
        lane = _LANE * now.view.distance
        from_w, to_w = (np.array([*(place + lane * aside), _RADIO_HEIGHT]) for place in (start_w, end_w))
        if not lost:
            now.pencil.line(from_w, to_w, (*colour[:3], self._link_opacity), 2.0)
            return
        half_w = 0.5 * (from_w + to_w)
        now.pencil.line(from_w, half_w, LOST_COLOUR, 3.0)
        cross = 2.5 * lane
        for side in (1.0, -1.0):
            arm = np.array([*(cross * (ahead + side * aside)), 0.0])
            now.pencil.line(half_w - arm, half_w + arm, LOST_COLOUR, 3.0)
