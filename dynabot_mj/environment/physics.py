"""The rigid robots behind dm_control's `Physics`: read as a `FleetState`, driven by local laws or directly."""

import numpy as np

from dynabot_mj.common.arrays import Array
from dynabot_mj.host import opengl
from dynabot_mj.plants import free_joint, scene
from dynabot_mj.plants.local_laws import Drivers
from dynabot_mj.plants.plant import LONGEST_SUBSTEP, FleetState
from dynabot_mj.plants.rigid_body import divided
from dynabot_mj.study import fleet
from dynabot_mj.study.scenario import Scenario

with opengl.for_dm_control():
    from dm_control import mujoco

_NOTHING_FELT = np.zeros((1, 1, 2))  # of accelerometers, on which the local laws do not run here


class FleetPhysics(mujoco.Physics):
    """All robots in MuJoCo, which local laws or wheel speeds drive; arrays as in studies, with B = 1 trial."""

    period: float  # of the local laws [s]
    steps: int  # of the physics in it
    _force_w: Array | None  # (1, n, 2) that the local laws follow [N]; None: wheel speeds are held

    def equip(self, setup: Scenario, gap: float) -> None:
        """Gives the robots their local laws.

        Args:
            setup: Their configuration.
            gap: For which commands will be held [s].
        """
        _, self.period, self.steps = divided(gap)
        self.model.opt.timestep = self.period / self.steps
        self._per_substep = max(1, int(LONGEST_SUBSTEP / self.model.opt.timestep + 1e-9))
        self._laws, self._robot = fleet.local_laws(setup), scene.read_robot(fleet.conditions(setup))
        count = setup.robots
        self._qpos = self.data.qpos.reshape(1, count, -1)
        self._qvel = self.data.qvel.reshape(1, count, -1)
        self._ctrl = self.data.ctrl.reshape(1, count, len(scene.WHEELS), 2)
        # Robots are alike and follow each other, their bodies behind the field's: so these are views as well.
        chassis = int(self.model.joint(f"{scene.prefix(0)}free").bodyid[0])
        hull = int(self.model.sensor(f"{scene.prefix(0)}hull_contact").adr[0])
        self._axes = self.data.xmat[chassis:].reshape(count, -1, 9)[:, 0]
        self._contacts = self.data.sensordata.reshape(count, -1)[:, hull]

    @property
    def state(self) -> FleetState:
        """The true state now; it does not know what accelerometers have felt."""
        return self._state

    @property
    def touched(self) -> bool:
        """Whether a hull has touched anything since the last command."""
        return self._touched

    def place(self, position_w: Array, heading: Array) -> None:
        """Puts the robots at rest on their settled tyres, (1, n, 2) [m], (1, n) [rad]."""
        free_joint.place(self._qpos, position_w, heading, self._robot.height, self._robot.orientation)
        self.forward()
        self._heading = heading
        self._state = self._read(0.0)
        self._drivers = Drivers(self._laws, self._robot.vehicle, self._state)
        self._touched = False

    def command_force(self, force_w: Array) -> None:
        """Lets the local laws follow a force on each robot from now on, (1, n, 2) [N]."""
        self._force_w, self._touched = force_w, False

    def command_wheels(self, speed: Array) -> None:
        """Holds wheel speeds from now on, (1, n, 4) [rad/s]."""
        self._ctrl[..., 0], self._ctrl[..., 1] = speed, 0.0
        self._force_w, self._touched = None, False

    def step(self, nstep: int = 1) -> None:
        """Advances by whole periods of the local laws, `nstep` physics steps in all."""
        start, periods = self._state.time, nstep // self.steps
        for local in range(periods):
            if self._force_w is not None:
                self._ctrl[..., 0], self._ctrl[..., 1] = self._drivers.drive(
                    self._force_w, self._state, self._qvel[..., 5].copy(), self._qvel[..., 6:], self.period
                )
            done = 0
            while done < self.steps:
                # A touch may be over before the period is: hulls push each other apart.
                count = min(self._per_substep, self.steps - done)
                done += count
                super().step(count)
                self._touched = self._touched or bool(self._contacts.any())
            # Rounded as studies round it.
            self._state = self._read(round(start + self.period * (local + 1), 9))

    def _read(self, time: float) -> FleetState:
        # MuJoCo's own axes, which dm_control keeps up to date, are quicker had than those of `free_joint.orientation`.
        axes = self._axes
        self._heading = free_joint.continued(self._heading, np.arctan2(axes[:, 3], axes[:, 0])[None])
        return FleetState(
            time=time,
            position_w=self._qpos[..., :2].copy(),
            velocity_w=self._qvel[..., :2].copy(),
            heading=self._heading,
            yaw_rate=(axes[:, 6:] * self._qvel[..., 3:6]).sum(axis=-1),
            velocity_increment_b=_NOTHING_FELT,
        )
