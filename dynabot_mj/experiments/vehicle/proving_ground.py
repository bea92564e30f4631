"""The proving ground: robots on the compiled model, their motors commanded directly, every step of it recorded.

There are no local laws here. A manoeuvre starts with the robots resting on their tyres, standing or rolling, and leaves
a trace: the states at the beginning of each physics step with the torques and contacts that act in it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from dynabot_mj.common.arrays import Array
from dynabot_mj.plants import scene
from dynabot_mj.plants.scene import Conditions

TURNING = np.array([-1.0, 1.0, -1.0, 1.0])  # of the wheels' speeds, in the order of `scene.WHEELS`
_STANDING = (0.0, 0.0, 0.0)
_APART = -1.0  # overlap of hulls that touch nothing [m]


@dataclass(frozen=True, kw_only=True)
class Trace:
    """States of n robots at the beginning of each of T steps, and what acts in that step."""

    time: Array  # (T,) [s]
    qpos: Array  # (T, n, 11): position, orientation, wheel angles [m, -, rad]
    qvel: Array  # (T, n, 10): velocity in the world, angular velocity in the body, wheel speeds [m/s, rad/s]
    torque: Array  # of the motors, (T, n, 4) [Nm]
    contacts: Array  # of tyres with the floor, (T,)
    overlap: Array  # of the hulls, (T,) [m]; -1: nothing touches a hull
    warnings: int  # of MuJoCo

    @property
    def touched(self) -> int:
        """First step in which something touches a hull; the last one if nothing does."""
        touching = self.overlap > _APART
        return int(np.argmax(touching)) if touching.any() else len(touching) - 1

    @property
    def forward(self) -> Array:
        """Way ahead along the initial heading, (T, n) [m]."""
        way = self.qpos[..., :2] - self.qpos[0, :, :2]
        return way[..., 0] * np.cos(self.heading[0]) + way[..., 1] * np.sin(self.heading[0])

    @property
    def sideways(self) -> Array:
        """Way to the left of the initial heading, (T, n) [m]."""
        way = self.qpos[..., :2] - self.qpos[0, :, :2]
        return way[..., 1] * np.cos(self.heading[0]) - way[..., 0] * np.sin(self.heading[0])

    @property
    def heading(self) -> Array:
        """Yaw, unwrapped, (T, n) [rad]."""
        w, x, y, z = np.moveaxis(self.qpos[..., 3:7], -1, 0)
        return np.unwrap(np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)), axis=0)

    @property
    def velocity_b(self) -> Array:
        """Velocity ahead and to the left, (T, n, 2) [m/s]."""
        cos, sin = np.cos(self.heading), np.sin(self.heading)
        x, y = self.qvel[..., 0], self.qvel[..., 1]
        return np.stack([cos * x + sin * y, cos * y - sin * x], axis=-1)

    @property
    def yaw_rate(self) -> Array:
        """Of robots that stand upright, (T, n) [rad/s]."""
        return self.qvel[..., 5]

    @property
    def wheel_speed(self) -> Array:
        """In the order of `scene.WHEELS`, (T, n, 4) [rad/s]."""
        return self.qvel[..., 6:]


class ProvingGround:
    """A field with n robots that rest on their tyres at the start of each manoeuvre."""

    def __init__(self, conditions: Conditions, timestep: float, robots: int = 1) -> None:
        """Compiles the field.

        Args:
            conditions: Which robots, on what ground.
            timestep: Of the physics [s].
            robots: Number of robots n.

        Raises:
            InputError: If the robot's model cannot be read.
        """
        # MuJoCo would print its warnings and append them to a file in the working directory; traces count them instead.
        mujoco.set_mju_user_warning(lambda message: None)
        self.robot = scene.read_robot(conditions)
        self._robots = robots
        self._model = scene.compose(robots, conditions).compile()
        self._model.opt.timestep = timestep
        names = [scene.prefix(index) for index in range(robots)]
        self._tyre = np.zeros(self._model.ngeom, dtype=bool)
        self._tyre[[self._model.geom(f"{name}{wheel}_tyre").id for name in names for wheel in scene.WHEELS]] = True
        self._hull = np.zeros(self._model.ngeom, dtype=bool)
        self._hull[[self._model.geom(f"{name}hull").id for name in names]] = True
        self.rolling_radius = 1.0  # until it is known; nothing rolls yet
        self.rolling_radius = self._rolling_radius()

    def run(
        self,
        duration: float,
        wheel_speed: float | Array | None,
        torque: float = 0.0,
        *,
        motion: tuple[float, float, float] = _STANDING,
        heading: float | Sequence[float] = 0.0,
        start: Sequence[tuple[float, float]] = ((0.0, 0.0),),
        stop_at_contact: bool = False,
    ) -> Trace:
        """Runs one manoeuvre.

        Args:
            duration: The longest [s].
            wheel_speed: Commands, a number or (4,) [rad/s]; None: motors off, so that not even back-EMF brakes.
            torque: Feed-forward of all motors [Nm].
            motion: Initial speed ahead and to the left [m/s] and yaw rate [rad/s]; the wheels roll along.
            heading: Initial, a number or one for each robot [rad].
            start: Initial places, one for each robot [m].
            stop_at_contact: Command the wheels to stand from when a hull is touched, and go on.
        """
        data = self._placed(motion, np.broadcast_to(heading, self._robots), np.array(start))
        off = int(mujoco.mjtDisableBit.mjDSBL_ACTUATION)
        self._model.opt.disableflags &= ~off
        if wheel_speed is None:
            self._model.opt.disableflags |= off
        else:
            data.ctrl[0::2], data.ctrl[1::2] = np.tile(np.broadcast_to(wheel_speed, 4), self._robots), torque
        steps = round(duration / self._model.opt.timestep)
        qpos, qvel = np.empty((steps, self._model.nq)), np.empty((steps, self._model.nv))
        torques, contacts, overlap = np.empty((steps, 4 * self._robots)), np.empty(steps), np.empty(steps)
        for step in range(steps):
            qpos[step], qvel[step] = data.qpos, data.qvel
            mujoco.mj_step(self._model, data)
            torques[step] = data.actuator_force
            contacts[step], overlap[step] = self._touching(data)
            if stop_at_contact and overlap[step] > _APART:
                data.ctrl[:] = 0.0
        return Trace(
            time=self._model.opt.timestep * np.arange(steps),
            qpos=qpos[:, : 11 * self._robots].reshape(steps, self._robots, 11),
            qvel=qvel[:, : 10 * self._robots].reshape(steps, self._robots, 10),
            torque=torques.reshape(steps, self._robots, 4),
            contacts=contacts,
            overlap=overlap,
            warnings=sum(int(warning.number) for warning in data.warning),
        )

    def energy(self, trace: Trace) -> Array:
        """Returns kinetic plus potential energy at each state of a trace, without that of the tyres, (T,) [J]."""
        data, total = mujoco.MjData(self._model), np.empty(len(trace.time))
        for step in range(len(total)):
            data.qpos[:], data.qvel[:] = trace.qpos[step].ravel(), trace.qvel[step].ravel()
            # What the energies are made of; a whole mj_forward would do the same and find the contacts too.
            mujoco.mj_kinematics(self._model, data)
            mujoco.mj_comPos(self._model, data)
            mujoco.mj_crb(self._model, data)
            mujoco.mj_energyPos(self._model, data)
            mujoco.mj_energyVel(self._model, data)
            total[step] = data.energy.sum()
        return total

    def _placed(self, motion: tuple[float, float, float], heading: Array, start: Array) -> mujoco.MjData:
        """Returns robots at rest on their tyres, or rolling on them."""
        data = mujoco.MjData(self._model)
        ahead, left, yaw_rate = motion
        for index, angle in enumerate(heading):
            pose, velocity = data.qpos[11 * index : 11 * index + 11], data.qvel[10 * index : 10 * index + 10]
            pose[:2], pose[2] = start[index], self.robot.height
            turn = np.array([math.cos(angle / 2.0), 0.0, 0.0, math.sin(angle / 2.0)])
            mujoco.mju_mulQuat(pose[3:7], turn, np.array(self.robot.orientation))
            velocity[0] = ahead * math.cos(angle) - left * math.sin(angle)
            velocity[1] = ahead * math.sin(angle) + left * math.cos(angle)
            velocity[5] = yaw_rate
            velocity[6:] = (ahead + TURNING * yaw_rate * self.robot.vehicle.track / 2.0) / self.rolling_radius
        return data

    def _rolling_radius(self) -> float:
        """Returns the height of an axle above the point where MuJoCo puts the contact of its tyre [m].

        That is half-way into the overlap of tyre and floor, so the radius is larger than the axle's height.
        """
        data = self._placed(_STANDING, np.zeros(self._robots), np.zeros((self._robots, 2)))
        mujoco.mj_forward(self._model, data)
        axle = data.joint(f"{scene.prefix(0)}{scene.WHEELS[0]}").xanchor[2]
        touching = self._tyre[data.contact.geom].any(axis=1)
        return float(axle - data.contact.pos[touching, 2].mean())

    def _touching(self, data: mujoco.MjData) -> tuple[int, float]:
        """Returns how many tyres touch the floor, and how far anything overlaps a hull [m]."""
        geoms, depth = data.contact.geom, -data.contact.dist
        # Tyres meet nothing but the floor.
        return int(self._tyre[geoms].any(axis=1).sum()), float(depth[self._hull[geoms].any(axis=1)].max(initial=_APART))
