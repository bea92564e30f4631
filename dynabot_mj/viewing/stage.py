"""A trial as a MuJoCo model to look at: robots in their colours, what they believe, the leader and the well's rings.

Everything is a body or a geom of the model, so that any viewer of MuJoCo models shows it. Nothing is simulated here.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from dynabot_mj.common.arrays import Array
from dynabot_mj.common.legend import ROBOT_COLOURS, rgb
from dynabot_mj.plants import scene
from dynabot_mj.plants.kinds import KINDS
from dynabot_mj.study import assembly, fleet
from dynabot_mj.study.scenario import Case, Scenario

TRAIL = 20.0  # how far back a robot's trail reaches [s]
TRAIL_SPACING = 0.2  # between two points of it [s]

_RING_SEGMENTS = 120
_RING_COLOURS = ((0.85, 0.70, 0.05, 1.0), (0.60, 0.60, 0.60, 1.0))  # of h0, as the leader; of h0 + eps
_GHOST_RADIUS, _GHOST_HEIGHT, _GHOST_OPACITY = 0.12, 0.45, 0.55  # [m], [m]; above the robot, which would hide it
_NOWHERE = (0.0, 0.0, -100.0)  # where a robot believes to be that does not know [m]


@dataclass(frozen=True, kw_only=True)
class Snapshot:
    """What is seen at one instant."""

    time: float  # [s]
    position_w: Array  # (n, 2) true [m]
    pose: Array | None  # (n, 11) MuJoCo coordinates (free joint 7, four wheel angles); None: point masses
    believed_w: Array  # (n, 2) where each robot believes to be [m]; NaN where it does not know


class Stage:
    """The model, and its state as of a snapshot."""

    def __init__(self, setup: Scenario, case: Case, *, signs: bool = True) -> None:
        """Composes and compiles the model.

        Args:
            setup: The study's configuration.
            case: One of them; its point masses are spheres as wide as the distance at which they collide.
            signs: With the rings and what robots believe, for whoever draws none of it.
        """
        bodies, ghosts = KINDS[case.plant].body, signs and case.perception is not None
        field = scene.compose(setup.robots if bodies else 0, fleet.conditions(setup))
        well = assembly.field(setup, case.estimator).leader
        self.rings = tuple(zip((well.radius, well.radius + well.width), _RING_COLOURS, strict=True))  # [m], RGBA
        for radius, ring in self.rings if signs else ():
            _add_ring(field, radius, ring)
        for robot in range(setup.robots):
            colour = rgb(ROBOT_COLOURS[robot])
            if not bodies:
                _add_ball(field, _point(robot), setup.collision_distance / 2.0, (*colour, 1.0))
            elif paint := field.material(f"{scene.prefix(robot)}paint"):  # another robot's MJCF may have none
                paint.rgba = [*colour, 1.0]
            if ghosts:
                _add_ball(field, _ghost(robot), _GHOST_RADIUS, (*colour, _GHOST_OPACITY))
        self.robots = setup.robots
        self.model = field.compile()
        self.data = mujoco.MjData(self.model)
        self._point_height = setup.collision_distance / 2.0
        self._points = [self._mocap(_point(robot)) for robot in range(setup.robots)] if not bodies else []
        self._ghosts = [self._mocap(_ghost(robot)) for robot in range(setup.robots)] if ghosts else []

    def place(self, snapshot: Snapshot) -> None:
        """Puts everything where it is in a snapshot."""
        self.data.time = snapshot.time
        if snapshot.pose is not None:
            self.data.qpos[:] = snapshot.pose.ravel()
        for mocap, place in zip(self._points, snapshot.position_w, strict=bool(self._points)):
            self.data.mocap_pos[mocap] = (*place, self._point_height)
        for mocap, place in zip(self._ghosts, snapshot.believed_w, strict=bool(self._ghosts)):
            known = bool(np.isfinite(place).all())
            self.data.mocap_pos[mocap] = (*place, _GHOST_HEIGHT) if known else _NOWHERE
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_camlight(self.model, self.data)

    def _mocap(self, name: str) -> int:
        return int(self.model.body(name).mocapid[0])


def trail(snapshots: Sequence[Snapshot], index: int) -> Array:
    """Returns where the robots have come from, (n, P, 2) [m], the latest place last; P is at least 1.

    Args:
        snapshots: Evenly spaced in time.
        index: Of the one that is shown.
    """
    spacing = snapshots[1].time - snapshots[0].time if len(snapshots) > 1 else TRAIL_SPACING
    stride = max(1, round(TRAIL_SPACING / spacing))
    # Points stay where they are while the robots move on, and so do dashes, each from an even one to the next.
    first = 2 * stride * -(-max(0, index - round(TRAIL / spacing)) // (2 * stride))
    chosen = [*range(first, index, stride), index]
    return np.stack([snapshots[one].position_w for one in chosen], axis=1)


def _add_ring(field: mujoco.MjSpec, radius: float, colour: Sequence[float]) -> None:
    """Lays a ring of thin boxes around the leader on the floor."""
    for angle in 2.0 * np.pi * np.arange(_RING_SEGMENTS) / _RING_SEGMENTS:
        field.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[0.03, 1.05 * np.pi * radius / _RING_SEGMENTS, 0.004],
            pos=[radius * np.cos(angle), radius * np.sin(angle), 0.005],
            quat=[np.cos(angle / 2.0), 0.0, 0.0, np.sin(angle / 2.0)],
            contype=0,
            conaffinity=0,
            group=1,
            rgba=colour,
        )


def _add_ball(field: mujoco.MjSpec, name: str, radius: float, colour: Sequence[float]) -> None:
    """Adds a sphere that is put where it belongs by hand."""
    body = field.worldbody.add_body(name=name, mocap=True, pos=_NOWHERE)
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_SPHERE,
        size=[radius, 0.0, 0.0],
        contype=0,
        conaffinity=0,
        group=1,
        rgba=colour,
    )


def _point(robot: int) -> str:
    return f"point{robot}"


def _ghost(robot: int) -> str:
    return f"ghost{robot}"
