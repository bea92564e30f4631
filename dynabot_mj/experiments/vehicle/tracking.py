"""How well a vehicle imitates a particle: both under the same courses of force, one robot at a time."""

from dataclasses import dataclass

import numpy as np

from dynabot_mj.common.arrays import Array
from dynabot_mj.controllers.law import Information
from dynabot_mj.controllers.potential_field import polygon_circumradius
from dynabot_mj.experiments.vehicle import manoeuvres, period_ends
from dynabot_mj.experiments.vehicle.manoeuvres import Courses
from dynabot_mj.formation.leader import LEADER_W
from dynabot_mj.formation.options import FieldOptions
from dynabot_mj.perception.surrogates import PerfectPerception
from dynabot_mj.plants import scene
from dynabot_mj.plants.local_laws import LocalLaws
from dynabot_mj.plants.particle import ParticlePlant
from dynabot_mj.plants.plant import Plant
from dynabot_mj.plants.rigid_body import RigidBodyPlant
from dynabot_mj.testbed import paper
from dynabot_mj.testbed.radio import INSTANT_LINK, Radio
from dynabot_mj.trial.clocks import Clocks
from dynabot_mj.trial.loop import Parts

FIELD = FieldOptions()  # whose dissipation and wells the courses have
WELL_RADIUS = polygon_circumradius(FIELD.spacing, paper.ROBOTS)  # h0 [m]


@dataclass(frozen=True, kw_only=True)
class Motion:
    """Courses as they were driven, at the end of each control period."""

    time: Array  # (K,) [s]
    position_w: Array  # (S, K, 2) [m]
    velocity_w: Array  # (S, K, 2) [m/s]

    def part(self, courses: slice) -> "Motion":
        """Returns some of the courses."""
        return Motion(time=self.time, position_w=self.position_w[courses], velocity_w=self.velocity_w[courses])


@dataclass(frozen=True, kw_only=True)
class Tracking:
    """A vehicle beside its particle."""

    vehicle: Motion
    particle: Motion
    wheel_slip: Array  # largest on each course, (S,) [m/s]

    @property
    def velocity_error(self) -> Array:
        """RMS of each course, (S,) [m/s]."""
        return _rms(self.vehicle.velocity_w - self.particle.velocity_w)

    @property
    def position_error(self) -> Array:
        """RMS of each course, (S,) [m]."""
        return _rms(self.vehicle.position_w - self.particle.position_w)

    def part(self, courses: slice) -> "Tracking":
        """Returns some of the courses."""
        return Tracking(
            vehicle=self.vehicle.part(courses),
            particle=self.particle.part(courses),
            wheel_slip=self.wheel_slip[courses],
        )

    def cost(self, position_weight: float) -> Array:
        """Returns the tuning's cost of each course without its soft limits, (S,) [m^2/s^2]."""
        return self.velocity_error**2 + position_weight * self.position_error**2


def follow(
    courses: Courses,
    laws: LocalLaws,
    conditions: scene.Conditions = scene.NOMINAL,
    friction: Array | None = None,
) -> Tracking:
    """Drives vehicles and particles through courses, each in its own field.

    Args:
        courses: S of them.
        laws: Of the vehicles.
        conditions: Which vehicles, and on what ground.
        friction: Of each course's ground, (S,); None: as in the conditions.
    """
    start, heading = courses.start_w[:, None], np.zeros((len(courses.start_w), 1))
    vehicle = RigidBodyPlant(start, heading, laws, conditions=conditions, friction=friction)
    particle = ParticlePlant(scene.read_robot(conditions).vehicle.mass, start, heading)
    return Tracking(vehicle=_drive(vehicle, courses), particle=_drive(particle, courses), wheel_slip=vehicle.wheel_slip)


def _drive(plant: Plant, courses: Courses) -> Motion:
    """Runs a trial of one robot for each course, in the same loop as the study's."""
    count, periods = courses.force_w.shape[:2]

    def law(known: Information) -> Array:
        push = courses.force_w[:, round(known.time / courses.period)]
        wells = manoeuvres.field_force(known.position_w[:, 0], courses, WELL_RADIUS, FIELD.width, FIELD.spacing)
        return (push + wells - FIELD.dissipation * known.velocity_w[:, 0])[:, None]

    ends = period_ends.drive(
        Parts(
            clocks=Clocks(
                tick=courses.period,
                sample_ticks=1,
                control_ticks=1,
                duration_ticks=periods,
                phase=np.zeros(1, dtype=np.int64),
            ),
            plant=plant,
            perception=PerfectPerception(),
            radio=Radio(INSTANT_LINK, 1, 0, range(count)),  # with nobody to be heard
            law=law,
            leader_w=LEADER_W,
        )
    )
    return Motion(
        time=ends.time[1:],
        position_w=np.ascontiguousarray(ends.position_w[1:, :, 0].swapaxes(0, 1)),
        velocity_w=np.ascontiguousarray(ends.velocity_w[1:, :, 0].swapaxes(0, 1)),
    )


def _rms(error_w: Array) -> Array:
    return np.sqrt((error_w**2).sum(axis=-1).mean(axis=-1))
