"""What the trials of a case are made of: starts, plant, perception, velocity, and what they are judged against."""

from collections.abc import Callable, Sequence

import numpy as np

from dynabot_mj import scenario, scene
from dynabot_mj.arrays import Array
from dynabot_mj.controllers.potential_field import PotentialField, polygon_circumradius
from dynabot_mj.estimation.build import build
from dynabot_mj.filter_perception import FilterPerception
from dynabot_mj.metrics import Formation
from dynabot_mj.perception import Belief, FittedPerception, GaussMarkovPerception, Perception, PerfectPerception
from dynabot_mj.plants import FleetState, Plant
from dynabot_mj.plants.particle import ParticlePlant
from dynabot_mj.plants.rigid_body import RigidBodyPlant
from dynabot_mj.scenario import Case, Scenario
from dynabot_mj.streams import Purpose, generators
from dynabot_mj.testbed import SETTLING_SHARE

LEADER_W = np.zeros(2)  # the leader's position, known to every robot exactly and at once [m]


def starts(setup: Scenario, trials: Sequence[int]) -> tuple[Array, Array]:
    """Returns where the robots start: a regular polygon turned at random, its centroid left of the leader.

    Args:
        setup: The study's configuration.
        trials: Numbers of the trials, length B.

    Returns:
        Positions, (B, n, 2) [m], and headings, (B, n) [rad].
    """
    n, options = setup.robots, setup.start
    turn = np.array([g.random() for g in generators(setup.seed, trials, Purpose.START)]) * 2.0 * np.pi
    corner = turn[:, None] + 2.0 * np.pi * np.arange(n) / n
    radius = polygon_circumradius(options.spacing, n)
    centroid_w = LEADER_W - np.array([options.distance, 0.0])
    position_w = centroid_w + radius * np.stack([np.cos(corner), np.sin(corner)], axis=-1)
    if options.headings == "leader":
        to_leader = LEADER_W - position_w
        return position_w, np.arctan2(to_leader[..., 1], to_leader[..., 0])
    uniform = np.array([g.random(n) for g in generators(setup.seed, trials, Purpose.HEADING)])
    return position_w, (2.0 * uniform - 1.0) * np.pi


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
