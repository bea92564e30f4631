"""From a configuration to the parts of trials: plant, perception, radio, law, and what judges them."""

import math
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from dynabot_mj.common.arrays import Array, Progress
from dynabot_mj.controllers.potential_field import PotentialField, Well, polygon_circumradius
from dynabot_mj.formation import laws
from dynabot_mj.formation.leader import LEADER_W
from dynabot_mj.formation.metrics import Formation
from dynabot_mj.formation.starts import starts
from dynabot_mj.perception.belief import Belief, Perception
from dynabot_mj.perception.estimators import build
from dynabot_mj.perception.filters import FilterPerception
from dynabot_mj.perception.options import FittedError
from dynabot_mj.perception.surrogates import FittedPerception, GaussMarkovPerception, PerfectPerception
from dynabot_mj.plants import scene
from dynabot_mj.plants.kinds import KINDS
from dynabot_mj.plants.plant import FleetState, Plant, WheeledPlant
from dynabot_mj.study import fleet, scenario
from dynabot_mj.study.scenario import Case, Scenario
from dynabot_mj.testbed.paper import SETTLING_SHARE
from dynabot_mj.testbed.radio import INSTANT_LINK, Link, Radio, dynabot_link
from dynabot_mj.trial import loop
from dynabot_mj.trial.clocks import Clocks
from dynabot_mj.trial.judge import Judge, Outcome
from dynabot_mj.trial.loop import Observer, Parts
from dynabot_mj.trial.team import own_velocity


def simulate(
    setup: Scenario,
    case: Case,
    trials: Sequence[int],
    *,
    phase: npt.NDArray[np.int64] | None = None,
    recorded: int = 0,
    threads: int = 1,
    progress: Progress = lambda share: None,
    observers: Sequence[Observer] = (),
) -> Outcome:
    """Runs trials of one case of a study.

    Args:
        setup: The study's configuration.
        case: Plant, perception and estimator; of `cases`.
        trials: Numbers of the trials, length B; a trial's result depends on its number, not on the others.
        phase: Of each robot's clock, see `parts`.
        recorded: R, for how many of the trials the trajectory is kept.
        threads: Of the rigid plant.
        progress: Called now and then with the share of the work that is done.
        observers: Are shown everything, beside the judge.

    Raises:
        InputError: If the case's estimator has no periods that the processor can keep.

    Returns:
        Scores (B,), positions at the end (B, n, 2) [m], trajectories (R, K, n, 2) [m] at times (K,) [s], and more.

    Example:
        >>> setup = dy.build_scenario({"trials": 2, "duration": 1.0, "plants": ["particle"], "estimators": ["gps"]})
        >>> outcome = dy.simulate(setup, dy.cases(setup)[0], trials=range(5), recorded=1)
        >>> outcome.final_position_w.shape, outcome.trajectory_w.shape
        ((5, 3, 2), (1, 11, 3, 2))
    """
    made = parts(setup, case, trials, phase=phase, threads=threads)
    judging = judge(setup, case, made, recorded)
    loop.simulate(made, [judging, *observers], progress)
    return judging.outcome()


def parts(
    setup: Scenario,
    case: Case,
    trials: Sequence[int],
    *,
    phase: npt.NDArray[np.int64] | None = None,
    threads: int = 1,
) -> Parts:
    """Makes what trials of a case are made of.

    Args:
        setup: The study's configuration.
        case: Plant, perception and estimator.
        trials: Numbers of the trials, length B; a trial's result depends on its number, not on the others.
        phase: Of each robot's clock, (n,) [ticks]: its first event; None where all share one clock. It is the same in
            all trials, whose calendar would otherwise depend on which of them run together.
        threads: Of the rigid plant.

    Raises:
        InputError: If the case's estimator has no periods that the processor can keep.

    Example:
        >>> setup = dy.build_scenario({"trials": 2, "duration": 1.0, "plants": ["particle"], "estimators": ["gps"]})
        >>> parts = dy.make_parts(setup, dy.cases(setup)[0], trials=[0, 7])
        >>> parts.clocks.sample_period, parts.plant.state.position_w.shape
        (0.027, (2, 3, 2))
    """
    tick = setup.processor.tick
    sample_ticks, control_ticks = scenario.periods(setup, case.estimator)
    clocks = Clocks(
        tick=tick,
        sample_ticks=sample_ticks,
        control_ticks=control_ticks,
        duration_ticks=round(scenario.duration(setup) / tick),
        phase=np.zeros(setup.robots, dtype=np.int64) if phase is None else phase,
    )
    plant = fleet.plant(setup, case, *starts(setup.start, setup.robots, setup.seed, trials), trials, threads)
    return Parts(
        clocks=clocks,
        plant=plant,
        perception=perception(setup, case, clocks.sample_period, trials, plant.state),
        radio=Radio(link(setup, case.estimator), setup.robots, setup.seed, trials),
        law=laws.build(setup.controller, field(setup, case.estimator)),
        leader_w=LEADER_W,
        velocity=velocity(setup, case, plant),
    )


def judge(setup: Scenario, case: Case, made: Parts, recorded: int = 0) -> Judge:
    """Builds what judges trials of a case.

    Args:
        setup: The study's configuration.
        case: Plant, perception and estimator.
        made: Of these trials.
        recorded: For how many of them the trajectory is kept.
    """
    return Judge(made, formation(setup, case.estimator), errs=case.perception is not None, recorded=recorded)


def perception(
    setup: Scenario, case: Case, sample_period: float, trials: Sequence[int], start: FleetState
) -> Perception:
    """Builds what tells the robots of some trials of a case about themselves; `start` is their state at time 0."""
    name, method = case.estimator, scenario.method(setup, case.estimator)
    match case.perception:
        case None:
            return PerfectPerception()
        case "gauss-markov":
            sigma = method.uncertainty
            return GaussMarkovPerception(
                sigma if setup.surrogate.sigma == "per-axis" else sigma / math.sqrt(2.0),
                setup.surrogate.correlation_time,
                sample_period,
                setup.robots,
                setup.seed,
                trials,
            )
        case "filter":
            estimator = build(name, start.heading.shape, setup.filter, setup.filter.implementation, own=method.filter)
            return FilterPerception(
                estimator,
                setup.sensors,
                sample_period,
                setup.seed,
                trials,
                start,
                alignment=setup.filter.alignment,
                uphill=setup.vehicle.slope if KINDS[case.plant].body else 0.0,
            )
        case "fitted":
            error: FittedError = getattr(setup.fitted, name)
            return FittedPerception(
                error.position, error.velocity, error.heading, sample_period, setup.robots, setup.seed, trials
            )


def velocity(setup: Scenario, case: Case, plant: Plant) -> Callable[[Belief], Array]:
    """Returns where the velocity of the dissipation comes from, at a sample."""
    match scenario.velocity(setup, case):
        case "truth":
            return lambda told: plant.state.velocity_w
        case "odometry" if isinstance(plant, WheeledPlant):
            return lambda told: plant.odometry_w
        case "reference" if isinstance(plant, WheeledPlant):
            return lambda told: plant.reference_w
        case _:
            return own_velocity


def link(setup: Scenario, estimator: str) -> Link:
    """Returns the radio model of a row; perfect information is instantaneous."""
    if estimator == "perfect":
        return INSTANT_LINK
    return dynabot_link(setup.robots, setup.radio.message_bytes)


def field(setup: Scenario, estimator: str) -> PotentialField:
    """Returns the potential field of a row."""
    row, options = scenario.method(setup, estimator), setup.field
    neighbour_range = options.neighbour_range
    if neighbour_range == "auto":
        neighbour_range = 10.0 if setup.robots <= 5 else 7.5
    leader = Well(
        gain=row.alpha_h,
        radius=polygon_circumradius(options.spacing, setup.robots),
        width=options.width,
        range=options.leader_range,
        closest=options.closest,
    )
    neighbour = Well(
        gain=row.alpha_d,
        radius=options.spacing,
        width=options.width,
        range=neighbour_range,
        closest=options.closest,
    )
    return PotentialField(
        leader=leader, neighbour=neighbour, dissipation=options.dissipation, force_limit=row.force_limit
    )


def formation(setup: Scenario, estimator: str) -> Formation:
    """Builds what the trials of a row are judged by."""
    vehicle, wells = scene.read_robot(fleet.conditions(setup)).vehicle, field(setup, estimator)
    return Formation(
        well_radius=wells.leader.radius,
        spacing=wells.neighbour.radius,
        width=setup.field.width,
        settling_band=SETTLING_SHARE * setup.start.distance,
        tolerance=scenario.method(setup, estimator).uncertainty,
        collision_distance=setup.collision_distance,
        # Bodies are pushed apart from there on; bare hulls would touch only in hard collisions.
        length=vehicle.length + 2.0 * vehicle.margin,
        breadth=vehicle.breadth + 2.0 * vehicle.margin,
        fit=setup.completion.fit,
    )
