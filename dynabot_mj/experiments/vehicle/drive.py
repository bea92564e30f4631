"""The acceptance drive: what one rigid vehicle does when its motors are commanded directly, without local laws.

Each manoeuvre of `drives` is run on the proving ground, and `drive_figures` reads the figures off its trace.
"""

from dataclasses import dataclass, replace

from dynabot_mj.common.arrays import Array
from dynabot_mj.experiments.vehicle import drive_figures, drives
from dynabot_mj.experiments.vehicle.drive_figures import Figures
from dynabot_mj.experiments.vehicle.proving_ground import ProvingGround, Trace
from dynabot_mj.plants import scene
from dynabot_mj.plants.scene import Conditions, Robot

TIMESTEP = 0.004  # of the MJCF [s]


@dataclass(frozen=True, kw_only=True)
class DriveReport:
    """The figures, and the traces that they were read from."""

    conditions: Conditions
    robot: Robot
    figures: Figures
    launch: Trace
    brake: Trace
    corners: dict[tuple[float, float], Trace]  # by speed [m/s] and wheel difference [rad/s]
    energy: tuple[tuple[Array, Array], ...]  # of each of SLIDES: time [s] and energy [J], (T,)
    resting_energy: float  # [J]
    collisions: tuple[Trace, ...]  # by phase


def drive(conditions: Conditions = scene.NOMINAL, timestep: float = TIMESTEP) -> DriveReport:
    """Drives everything on the proving ground.

    Args:
        conditions: Which robot, its payload and the friction; the slopes are its own.
        timestep: Of the physics [s].

    Raises:
        InputError: If the robot's model cannot be read.
    """
    level = replace(conditions, slope=0.0)
    ground = ProvingGround(level, timestep)
    driven = drives.run(ground, level, timestep)
    energies = [ground.energy(slide) for slide in driven.slides]
    return DriveReport(
        conditions=conditions,
        robot=ground.robot,
        figures=drive_figures.read(ground, driven, energies, timestep),
        launch=driven.launch,
        brake=driven.brake,
        corners=driven.corners,
        resting_energy=float(ground.energy(driven.launch)[0]),
        energy=tuple((slide.time, energy) for slide, energy in zip(driven.slides, energies, strict=True)),
        collisions=tuple(driven.collisions),
    )
