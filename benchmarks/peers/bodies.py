"""Our loop of rigid robots against plain Python over `mj_step`: `python benchmarks/peers/bodies.py`.

The plain loop has an `MjData` for each trial and repeats the motors' commands that our loop gave, so that both do the
same physics: what it would cost to find them is not in it. In CPU time of one thread, in turn.
"""

import statistics

import mujoco
import numpy as np
from common import versions

import dynabot_mj as dy
from dynabot_mj.common import tables
from dynabot_mj.experiments.formation.loop_benchmark import in_turn
from dynabot_mj.plants.replay import Recording
from dynabot_mj.study import assembly
from dynabot_mj.trial import loop

ROBOTS, DURATION, REPETITIONS = 3, 2.88, 3
TRIALS = {1: 32, 10: 4, 100: 1}  # and how many control periods a turn has


class Plain:
    """One simulation after the other."""

    def __init__(self, recording: Recording) -> None:
        """Puts the robots where they were."""
        self._recording, self._done = recording, 0
        self._model = recording.model
        self.data = [mujoco.MjData(self._model) for _ in recording.qpos]
        for data, qpos in zip(self.data, recording.qpos, strict=True):
            data.qpos[:] = qpos

    def run(self, commands: int) -> None:
        """Repeats the next commands."""
        for command in self._recording.commands[self._done : self._done + commands]:
            self._model.opt.timestep = command.timestep
            for data, ctrl in zip(self.data, command.ctrl, strict=True):
                data.ctrl[:] = ctrl
                for _ in range(command.steps):
                    mujoco.mj_step(self._model, data)
        self._done += commands


def main() -> None:
    """Prints the table."""
    setup = dy.build_scenario(
        {"plants": ["rigid"], "estimators": ["decoupled"], "robots": ROBOTS, "duration": DURATION}
    )
    case = dy.cases(setup)[0]
    body = []
    for trials, turn in TRIALS.items():
        parts = dy.make_parts(setup, case, trials=range(trials))
        recording = parts.plant.record()
        loop.simulate(parts)
        spent = []
        for _ in range(REPETITIONS):
            parts, plain = dy.make_parts(setup, case, trials=range(trials)), Plain(recording)
            spent.append(in_turn(parts, assembly.judge(setup, case, parts), plain.run, turn)[:, 0])
        reached = np.array([data.qpos for data in plain.data]).reshape(parts.plant.state.pose.shape)
        apart = float(np.abs(reached - parts.plant.state.pose).max())
        ours_us, plain_us = 1e6 * np.median(spent, axis=0) / (len(recording.commands) * trials)
        ratio = statistics.median(float(plain / ours) for ours, plain in spent)
        body.append([str(trials), f"{ours_us:.0f}", f"{plain_us:.0f}", f"{ratio:.2f}", f"{apart:.0e}"])
    print("# Rigid robots: CPU time of an env-step\n")
    header = ["trials", "our loop [us]", "plain mj_step [us]", "plain/ours", "end apart by [m, rad]"]
    print("\n".join(tables.aligned(header, body)))
    print(f"\n{ROBOTS} robots, {1e3 * parts.clocks.sample_period:.0f} ms; medians of {REPETITIONS} repetitions of")
    print(f"{DURATION} s. Above 1 the plain loop takes longer. {versions('mujoco', 'numpy')}.")


if __name__ == "__main__":
    main()
