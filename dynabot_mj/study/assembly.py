"""From a configuration to the parts of trials: plant, perception, velocity, radio, law, and what judges them."""

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from dynabot_mj.common.arrays import Array, Progress
from dynabot_mj.controllers.potential_field import PotentialField
from dynabot_mj.estimation.build import build
from dynabot_mj.formation import laws
from dynabot_mj.formation.leader import LEADER_W
from dynabot_mj.formation.metrics import Formation
from dynabot_mj.formation.starts import starts
from dynabot_mj.perception.belief import Belief, Perception
from dynabot_mj.perception.filters import FilterPerception
from dynabot_mj.perception.surrogates import FittedPerception, GaussMarkovPerception, PerfectPerception
from dynabot_mj.plants import scene
from dynabot_mj.plants.particle import ParticlePlant
from dynabot_mj.plants.plant import FleetState, Plant
from dynabot_mj.plants.rigid_body import RigidBodyPlant
from dynabot_mj.study import scenario
from dynabot_mj.study.scenario import Case, Scenario
from dynabot_mj.testbed.paper import SETTLING_SHARE
from dynabot_mj.testbed.radio import Radio
from dynabot_mj.trial import loop
from dynabot_mj.trial.clocks import Clocks
from dynabot_mj.trial.loop import Observer, Outcome, Parts


def simulate(
    setup: Scenario,
    case: Case,
    trials: Sequence[int],
    *,
    phase: npt.NDArray[np.int64] | None = None,
    recorded: int = 0,
    threads: int = 1,
    progress: Progress = lambda share: None,
    observer: Observer | None = None,
) -> Outcome:
    """Runs trials of one case of a study; see `parts` and `loop.simulate`."""
    made = parts(setup, case, trials, phase=phase, threads=threads)
    return loop.simulate(made, recorded=recorded, progress=progress, observer=observer)


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
    driven = plant(setup, case, *starts(setup.start, setup.robots, setup.seed, trials), trials, threads)
    wells = scenario.field(setup, case.estimator)
    return Parts(
        clocks=clocks,
        plant=driven,
        perception=perception(setup, case, clocks.sample_period, trials, driven.state),
        velocity=velocity(setup, case, driven),
        radio=Radio(scenario.link(setup, case.estimator), setup.robots, setup.seed, trials),
        law=laws.build(setup.controller, wells),
        leader_w=LEADER_W,
        formation=formation(setup, case, wells),
        errs=case.perception is not None,
    )


def plant(
    setup: Scenario, case: Case, position_w: Array, heading: Array, trials: Sequence[int], threads: int = 1
) -> Plant:
    """Builds the robots of some trials of a case; see `starts` for their places and headings."""
    match case.plant:
        case "particle":
            return ParticlePlant(scenario.mass(setup), position_w, heading)
        case "rigid":
            return RigidBodyPlant(
                position_w,
                heading,
                scenario.laws(setup, real_sensors=case.perception in ("filter", "fitted")),
                conditions=scenario.conditions(setup),
                friction=scenario.friction(setup, trials),
                threads=threads,
            )


def perception(
    setup: Scenario, case: Case, sample_period: float, trials: Sequence[int], start: FleetState
) -> Perception:
    """Builds what tells the robots of some trials of a case about themselves; `start` is their state at time 0."""
    match case.perception:
        case None:
            return PerfectPerception()
        case "gauss-markov":
            return GaussMarkovPerception(
                scenario.deviation(setup, case.estimator),
                setup.surrogate.correlation_time,
                sample_period,
                setup.robots,
                setup.seed,
                trials,
            )
        case "filter":
            estimator = build(
                scenario.filter_name(case), start.heading.shape, setup.filter, setup.filter.implementation
            )
            return FilterPerception(
                estimator,
                setup.sensors,
                sample_period,
                setup.seed,
                trials,
                start,
                alignment=setup.filter.alignment,
                uphill=setup.vehicle.slope if case.plant == "rigid" else 0.0,
            )
        case "fitted":
            error = scenario.fitted(setup, case.estimator)
            return FittedPerception(
                error.position, error.velocity, error.heading, sample_period, setup.robots, setup.seed, trials
            )


def velocity(setup: Scenario, case: Case, driven: Plant) -> Callable[[Belief], Array]:
    """Returns where the velocity of the dissipation comes from, at a sample."""
    match scenario.velocity(setup, case):
        case "truth":
            return lambda fresh: driven.state.velocity_w
        case "odometry":
            return lambda fresh: driven.odometry_w
        case "reference":
            return lambda fresh: driven.reference_w
        case _:
            return lambda fresh: fresh.velocity_w


def formation(setup: Scenario, case: Case, field: PotentialField) -> Formation:
    """Builds what the trials of a case are judged against."""
    vehicle = scene.read_robot(scenario.conditions(setup)).vehicle
    return Formation(
        well_radius=field.leader.radius,
        spacing=field.neighbour.radius,
        width=setup.field.width,
        settling_band=SETTLING_SHARE * setup.start.distance,
        tolerance=scenario.method(setup, case.estimator).uncertainty,
        collision_distance=setup.collision_distance,
        # Bodies are pushed apart from there on; bare hulls would touch only in hard collisions.
        length=vehicle.length + 2.0 * vehicle.margin,
        breadth=vehicle.breadth + 2.0 * vehicle.margin,
        fit=setup.completion.fit,
    )
