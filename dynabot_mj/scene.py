"""From the MJCF files to a compiled field with n robots, and the vehicle's parameters read back from it."""

import functools
from dataclasses import dataclass

import mujoco
import numpy as np

import models
from controllers.vehicle import Vehicle

_SETTLING_TIME = 2.0  # after which a robot put on the ground is at rest [s]

WHEELS = ("front_left", "front_right", "rear_left", "rear_right")


def prefix(robot: int) -> str:
    """Returns what the names of a robot's parts begin with in a composed model."""
    return f"r{robot}/"


def compose(robots: int) -> mujoco.MjSpec:
    """Attaches robots to the field, and lets their tyres, and nothing else of them, roll on its floor.

    Args:
        robots: Number of robots n; they all stand at the origin.
    """
    field = mujoco.MjSpec.from_file(str(models.path("field.xml")))
    field.copy_during_attach = True
    robot = mujoco.MjSpec.from_file(str(models.path("dynabot.xml")))
    for index in range(robots):
        name = prefix(index)
        field.attach(robot, prefix=name, frame=field.worldbody.add_frame())
        for wheel in WHEELS:
            tyre = field.find_default(f"{name}tyre")
            field.add_pair(tyre, geomname1="floor", geomname2=f"{name}{wheel}_tyre")
    return field


@dataclass(frozen=True, kw_only=True)
class Robot:
    """One robot as the compiled model has it; the MJCF is the only place that states its numbers."""

    vehicle: Vehicle
    height: float  # of the chassis' origin when the robot rests on its tyres [m]
    orientation: tuple[float, float, float, float]  # of the chassis then, a quaternion without yaw


@functools.cache
def read_robot() -> Robot:
    """Compiles a field with one robot, lets it come to rest on its tyres and reads its parameters."""
    model = compose(1).compile()
    data = mujoco.MjData(model)
    for _ in range(round(_SETTLING_TIME / model.opt.timestep)):
        mujoco.mj_step(model, data)
    name = prefix(0)
    wheels = np.array([model.body(name + wheel).pos for wheel in WHEELS])
    hull = model.geom(f"{name}hull").size
    tyre = model.geom(f"{name}{WHEELS[0]}_tyre").id
    vehicle = Vehicle(
        mass=float(model.body(f"{name}chassis").subtreemass[0]),
        wheel_inertia=float(model.dof_M0[model.joint(name + WHEELS[0]).dofadr[0]]),
        # The field's floor is at height zero, so the axle's height is the radius that the loaded tyre rolls on.
        wheel_radius=float(data.body(name + WHEELS[0]).xpos[2]),
        track=float(np.ptp(wheels[:, 1])),
        wheelbase=float(np.ptp(wheels[:, 0])),
        length=2.0 * float(hull[0]),
        breadth=2.0 * float(hull[1]),
        friction=float(model.pair_friction[model.pair_geom2.tolist().index(tyre), 0]),
        torque_limit=float(model.actuator(name + WHEELS[0]).forcerange[1]),
    )
    pose = data.joint(f"{name}free").qpos
    return Robot(vehicle=vehicle, height=float(pose[2]), orientation=tuple(pose[3:7].tolist()))
