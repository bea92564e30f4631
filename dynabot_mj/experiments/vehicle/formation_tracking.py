"""How well the bodies imitate the particles in formation: perfect information, one local-law set, one ground."""

import math
from dataclasses import dataclass

import numpy as np

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.controllers import potential_field
from dynabot_mj.formation.leader import LEADER_W
from dynabot_mj.formation.metrics import Scores
from dynabot_mj.formation.scorer import Scorer
from dynabot_mj.formation.starts import starts
from dynabot_mj.plants.plant import Plant
from dynabot_mj.plants.rigid_body import RigidBodyPlant
from dynabot_mj.study import assembly, scenario
from dynabot_mj.study.scenario import Case, Scenario

FINAL = 10.0  # over which the yaw's path is taken [s]
_RIGID, _PARTICLE = (Case(plant=plant, perception=None, estimator="perfect") for plant in ("rigid", "particle"))


@dataclass(frozen=True, kw_only=True)
class FormationTracking:
    """Trials of rigid robots beside the same trials of particles."""

    rigid: Scores
    particle: Scores
    velocity_error: float  # RMS over robots, trials and the run [m/s]
    position_error: float  # RMS over robots, trials and the run [m]
    velocity_error_by_time: Array  # RMS over robots and trials in each second, (seconds,) [m/s]
    yaw_path: Array  # of the robot that turns most in the last 10 s, (B,) [rad]
    wheel_slip: Array  # largest, (B,) [m/s]
    hull_contact: Array  # (B,)
    diverged: BoolArray  # (B,) on either plant


@np.errstate(over="ignore", invalid="ignore")
def follow(setup: Scenario, trials: range) -> FormationTracking:
    """Runs the same trials on both plants, each acting on the truth about its own robots.

    Args:
        setup: The study's configuration, whose method `perfect` gives gains and period.
        trials: Their numbers.
    """
    position_w, heading = starts(setup.start, setup.robots, setup.seed, trials)
    period = scenario.periods(setup, "perfect")[1] * setup.processor.tick
    field = scenario.field(setup, "perfect")
    rigid = assembly.plant(setup, _RIGID, position_w, heading, trials)
    particle = assembly.plant(setup, _PARTICLE, position_w, heading, trials)
    assert isinstance(rigid, RigidBodyPlant)
    count = math.ceil(scenario.duration(setup) / period - 1e-9)
    formation = assembly.formation(setup, _RIGID, field)
    scorers = [Scorer(formation, LEADER_W, one.state, count * period) for one in (rigid, particle)]
    seconds = int((count - 1) * period) + 1
    squares, events = np.zeros((2, seconds)), np.zeros(seconds)
    yaw_path = np.zeros(heading.shape)
    for event in range(count):
        before = rigid.state
        for plant, scorer in zip((rigid, particle), scorers, strict=True):
            _advance(plant, scorer, field, period)
        healthy = ~(rigid.diverged | particle.diverged)
        second = int(event * period)
        ours, theirs = rigid.state, particle.state
        squares[0, second] += _square(ours.velocity_w - theirs.velocity_w, healthy)
        squares[1, second] += _square(ours.position_w - theirs.position_w, healthy)
        events[second] += 1.0
        if ours.time > count * period - FINAL:
            yaw_path += np.abs(ours.heading - before.heading)
    for plant, scorer in zip((rigid, particle), scorers, strict=True):
        scorer.control(plant.state)
    velocity, position = np.sqrt(squares.sum(axis=1) / events.sum())
    return FormationTracking(
        rigid=scorers[0].scores(),
        particle=scorers[1].scores(),
        velocity_error=float(velocity),
        position_error=float(position),
        velocity_error_by_time=np.sqrt(squares[0] / events),
        yaw_path=yaw_path.max(axis=-1),
        wheel_slip=rigid.wheel_slip,
        hull_contact=rigid.hull_contact.astype(float),
        diverged=rigid.diverged | particle.diverged,
    )


def _advance(plant: Plant, scorer: Scorer, field: potential_field.PotentialField, period: float) -> None:
    """Commands what perfect information gives, and holds it for a period."""
    state = plant.state
    n = state.heading.shape[1]
    neighbours_w = np.broadcast_to(state.position_w[:, None], (len(state.heading), n, n, 2))
    known = np.broadcast_to(~np.eye(n, dtype=bool), (len(state.heading), n, n))
    force_w = potential_field.total_force(state.position_w, state.velocity_w, LEADER_W, neighbours_w, known, field)
    scorer.control(state)
    for look in plant.step(force_w, period):
        scorer.look(look)


def _square(error_w: Array, healthy: BoolArray) -> float:
    return float((error_w[healthy] ** 2).sum(axis=-1).mean())
