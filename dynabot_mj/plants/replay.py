"""The raw engine: the motors' commands of a run, set again without local laws, sensors, looks and the loop.

The commands that a rigid plant gave are kept, one for each period of its local laws, and the engine sets them again
with one call for all physics steps of a period. So it drives alike, bit for bit, and what it costs is what MuJoCo costs
on just these motions: sliding tyres cost more than rolling ones.
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco import batch

from dynabot_mj.common.arrays import Array


@dataclass(frozen=True, kw_only=True)
class Command:
    """What the motors are told at the beginning of a period of the local laws, and held through it."""

    ctrl: Array  # (B, controls) of MuJoCo
    timestep: float  # of the physics [s]
    steps: int  # of it in the period


class Recording:
    """A fleet's start, and its commands since."""

    def __init__(self, model: mujoco.MjModel, qpos: Array) -> None:
        """Has no commands yet.

        Args:
            model: Of each trial.
            qpos: Where the robots are at rest, (B, coordinates).
        """
        self.model = model
        self.qpos = qpos.reshape(len(qpos), -1).copy()
        self.commands: list[Command] = []

    def take(self, ctrl: Array, timestep: float, steps: int) -> None:
        """Keeps a command; see `Command`."""
        self.commands.append(Command(ctrl=ctrl.reshape(len(ctrl), -1).copy(), timestep=timestep, steps=steps))


class Engine:
    """MuJoCo's batch, which repeats a recording."""

    def __init__(self, recording: Recording, threads: int = 1) -> None:
        """Puts the robots where they were.

        Args:
            recording: What is repeated; none of its trials may have diverged, since all are stepped to the end.
            threads: Of MuJoCo.
        """
        self._commands, self._done = recording.commands, 0
        self._batch = batch.Batch(recording.model, nsim=len(recording.qpos), nthread=threads)
        self._timestep = self._batch.expand("opt.timestep")
        self._qpos, self._ctrl = self._batch.bind("qpos"), self._batch.bind("ctrl")
        self._qpos[:] = recording.qpos

    @property
    def qpos(self) -> Array:
        """Where the robots are, (B, coordinates)."""
        return np.array(self._qpos)

    def run(self, commands: int | None = None) -> None:
        """Repeats the next commands, so many or all that are left."""
        end = len(self._commands) if commands is None else self._done + commands
        for command in self._commands[self._done : end]:
            self._ctrl[:] = command.ctrl
            self._timestep[:] = command.timestep
            self._batch.step(nstep=command.steps)
        self._done = end
