"""What a step of the `dm_env` environment costs, against a bare loop over `mj_step` with the same control period.

The robots are pushed by random forces, or turn their wheels at random speeds, new ones every second. The motors'
commands that this gives are recorded, and the bare loop sets them again, once per control period, with as many physics
steps: so both drive alike, and sliding tyres, which cost more than resting ones, are in both. Ratios are the median of
those within one repetition, loop over environment, in CPU time: 1 would be an environment that costs nothing.
"""

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any, get_args

import mujoco
import numpy as np

from dynabot_mj.common import tables
from dynabot_mj.common.arrays import Array
from dynabot_mj.environment import task
from dynabot_mj.environment.task import Action, Observation
from dynabot_mj.study.scenario import ESTIMATORS

_DURATION = 20.0  # of what is timed at once [s]
_CHANGE = 1.0  # after which there is another action [s]
_LARGEST = 20.0  # force on an axis [N], wheel speed [rad/s]


@dataclass(frozen=True, kw_only=True)
class StepRate:
    """One kind of environment."""

    estimator: str
    period_ms: float  # T_c
    action: Action
    observation: Observation
    environment_us: float  # per step of a control period
    loop_us: float  # of the bare loop, for the same period
    ratio: float


def run(robots: int, repetitions: int, progress: Callable[[float], None] = lambda share: None) -> list[StepRate]:
    """Measures all kinds of environments.

    Args:
        robots: In each.
        repetitions: Of each time.
        progress: Told the share of the work that is done.
    """
    kinds: list[tuple[str, Action, Observation]] = [
        (estimator, action, observation)
        for estimator in ESTIMATORS
        for action in get_args(Action)
        for observation in get_args(Observation)
    ]
    rows = []
    for done, kind in enumerate(kinds):
        rows.append(_row(robots, repetitions, *kind))
        progress((done + 1) / len(kinds))
    return rows


def document(rows: list[StepRate], robots: int, repetitions: int) -> dict[str, Any]:
    """Returns the JSON document."""
    return {
        "environment": {"robots": robots, "repetitions": repetitions, "rows": [asdict(row) for row in rows]},
    }


def markdown(rows: list[StepRate], robots: int, repetitions: int) -> str:
    """Returns the report as a table."""
    body = [
        [
            row.estimator,
            f"{row.period_ms:.0f}",
            row.action,
            row.observation,
            f"{row.environment_us:.0f}",
            f"{row.loop_us:.0f}",
            f"{row.ratio:.2f}",
        ]
        for row in rows
    ]
    header = ["estimator", "T_c [ms]", "action", "observation", "environment [us]", "mj_step loop [us]", "ratio"]
    lines = [
        f"# Cost of the environment, {robots} robots",
        "",
        *tables.aligned(header, body),
        "",
        f"CPU time per control period; medians of {repetitions} repetitions of {_DURATION:.0f} s. The loop replays the",
        "motors' commands; a ratio of 1 would be an environment that costs nothing.",
    ]
    return "\n".join(lines) + "\n"


def _row(robots: int, repetitions: int, estimator: str, action: Action, observation: Observation) -> StepRate:
    env = task.load(robots, action, observation, estimator, 2.0 * _DURATION)
    period = env.control_timestep()
    steps, per_action = round(_DURATION / period), round(_CHANGE / period)
    shape = env.action_spec().shape
    generator = np.random.default_rng(0)
    actions = _LARGEST * generator.uniform(-1.0, 1.0, (steps // per_action + 1, *shape))
    spent = np.array([_times(env, actions, steps, per_action) for _ in range(repetitions + 1)])[1:]  # one warms up
    environment_us, loop_us = 1e6 * np.median(spent, axis=0) / steps
    return StepRate(
        estimator=estimator,
        period_ms=1e3 * period,
        action=action,
        observation=observation,
        environment_us=float(environment_us),
        loop_us=float(loop_us),
        ratio=float(np.median(spent[:, 1] / spent[:, 0])),
    )


def _times(env: task.FormationEnvironment, actions: Array, steps: int, per_action: int) -> tuple[float, float]:
    """Returns the CPU time of the environment, and of the bare loop [s]."""
    env.reset()
    physics = env.physics
    start, commands = physics.data.qpos.copy(), np.empty((steps, physics.model.nu))
    begin = time.process_time()
    for step in range(steps):
        env.step(actions[step // per_action])
        commands[step] = physics.data.ctrl
    spent = time.process_time() - begin
    model = physics.model.ptr
    data = mujoco.MjData(model)
    data.qpos[:] = start
    substeps = round(env.control_timestep() / model.opt.timestep)
    begin = time.process_time()
    for command in commands:
        data.ctrl[:] = command
        for _ in range(substeps):
            mujoco.mj_step(model, data)
    return spent, time.process_time() - begin
