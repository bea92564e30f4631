"""From a configuration to robots: the plant, and what its vehicles weigh, stand on and are driven by."""

from collections.abc import Sequence

import numpy as np

from dynabot_mj.common.arrays import Array
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.common.streams import Purpose, generators
from dynabot_mj.controllers import gains, odometry
from dynabot_mj.controllers.gains import Gains
from dynabot_mj.controllers.steering import HandPoint, Heading
from dynabot_mj.plants import scene
from dynabot_mj.plants.local_laws import LocalLaws
from dynabot_mj.plants.particle import ParticlePlant
from dynabot_mj.plants.plant import Plant
from dynabot_mj.plants.rigid_body import RigidBodyPlant
from dynabot_mj.study.scenario import Case, Scenario


def plant(
    setup: Scenario, case: Case, position_w: Array, heading: Array, trials: Sequence[int], threads: int = 1
) -> Plant:
    """Builds the robots of some trials of a case; see `starts` for their places and headings."""
    match case.plant:
        case "particle":
            return ParticlePlant(mass(setup), position_w, heading)
        case "rigid":
            return RigidBodyPlant(
                position_w,
                heading,
                local_laws(setup, real_sensors=case.perception in ("filter", "fitted")),
                conditions=conditions(setup),
                friction=friction(setup, trials),
                threads=threads,
            )


def conditions(setup: Scenario) -> scene.Conditions:
    """Returns which rigid robots a study has, and their ground; friction that differs by trial is `friction`'s."""
    vehicle = setup.vehicle
    return scene.Conditions(
        model=vehicle.model,
        payload=vehicle.payload,
        slope=vehicle.slope,
        friction=vehicle.friction if isinstance(vehicle.friction, float) else None,
    )


def friction(setup: Scenario, trials: Sequence[int]) -> Array | None:
    """Returns the friction of each trial, (B,), where it differs from trial to trial."""
    if not isinstance(setup.vehicle.friction, tuple):
        return None
    low, high = setup.vehicle.friction
    return np.array([low + (high - low) * g.random() for g in generators(setup.seed, trials, Purpose.FRICTION)])


def mass(setup: Scenario) -> float:
    """Returns the mass of a particle, and of the point mass that a rigid robot imitates [kg]."""
    return scene.read_robot(conditions(setup)).vehicle.mass if setup.mass == "auto" else setup.mass


def gain_set(name: str) -> Gains:
    """Returns the gains of a name, or of a file.

    Raises:
        InputError: If there are none.
    """
    try:
        return gains.load(name)
    except (FileNotFoundError, ValueError) as error:
        raise InputError(str(error)) from error


def local_laws(setup: Scenario, *, real_sensors: bool = False) -> LocalLaws:
    """Returns the local laws of the rigid robots.

    Args:
        setup: The study's configuration.
        real_sensors: Whether accelerometer, gyro and heading have errors.

    Raises:
        InputError: If there are no such gains.

    Example:
        >>> type(dy.local_laws(dy.build_scenario({}, steering="heading")).steering).__name__
        'Heading'
    """
    found = gain_set(setup.vehicle.gains)
    steering: HandPoint | Heading = found.hand_point if setup.vehicle.steering == "hand-point" else found.heading
    on_board = setup.vehicle.sensing == "on-board"
    if not real_sensors:
        return LocalLaws(steering=steering, traction=found.traction, on_board=on_board)
    return LocalLaws(
        steering=steering,
        traction=found.traction,
        odometry=odometry.REAL_SENSORS,
        on_board=on_board,
        wheel_resolution=setup.sensors.wheels.speed,
    )
