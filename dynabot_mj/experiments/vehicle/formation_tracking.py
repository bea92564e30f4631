"""How well the bodies imitate the particles in formation: perfect information, one local-law set, one ground."""

from dataclasses import dataclass, replace

import numpy as np

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.experiments.vehicle import period_ends
from dynabot_mj.experiments.vehicle.period_ends import PeriodEnds
from dynabot_mj.formation.scorer import Scores
from dynabot_mj.study import assembly
from dynabot_mj.study.scenario import Case, Scenario
from dynabot_mj.trial.judge import Outcome

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


def follow(setup: Scenario, trials: range) -> FormationTracking:
    """Runs the same trials on both plants, each acting on the truth about its own robots.

    Args:
        setup: The study's configuration, whose method `perfect` gives gains and period.
        trials: Their numbers.
    """
    (rigid, driven), (particle, ideal) = (_run(setup, case, trials) for case in (_RIGID, _PARTICLE))
    healthy = ~(driven.diverged | ideal.diverged)[1:]
    second = driven.time[:-1].astype(int)
    velocity, position = (
        np.bincount(second, [_square(error_w, sound) for error_w, sound in zip(errors_w[1:], healthy, strict=True)])
        for errors_w in (driven.velocity_w - ideal.velocity_w, driven.position_w - ideal.position_w)
    )
    final = driven.time[1:] > driven.time[-1] - FINAL
    return FormationTracking(
        rigid=rigid.scores,
        particle=particle.scores,
        velocity_error=float(np.sqrt(velocity.sum() / len(second))),
        position_error=float(np.sqrt(position.sum() / len(second))),
        velocity_error_by_time=np.sqrt(velocity / np.bincount(second)),
        yaw_path=np.abs(np.diff(driven.heading, axis=0))[final].sum(axis=0).max(axis=-1),
        wheel_slip=rigid.wheel_slip,
        hull_contact=rigid.hull_contact,
        diverged=rigid.diverged | particle.diverged,
    )


def _run(setup: Scenario, case: Case, trials: range) -> tuple[Outcome, PeriodEnds]:
    """Runs whole control periods, in which robots sample when they act."""
    made = assembly.parts(setup, case, trials)
    control = made.clocks.control_ticks
    periods = -(-made.clocks.duration_ticks // control)
    made = replace(made, clocks=replace(made.clocks, sample_ticks=control, duration_ticks=control * periods))
    judging = assembly.judge(setup, case, made)
    ends = period_ends.drive(made, [judging])
    return judging.outcome(), ends


@np.errstate(over="ignore", invalid="ignore")  # of what has broken down
def _square(error_w: Array, healthy: BoolArray) -> float:
    return float((error_w[healthy] ** 2).sum(axis=-1).mean())
