"""From the MJCF files to a compiled field with n robots, and the vehicle's parameters read back from it."""

import functools
import math
import os
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from dynabot_mj import models
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.controllers.vehicle import Vehicle

_SETTLING_TIME = 2.0  # after which a robot put on the ground is at rest [s]
_PAYLOAD_SIZE = (0.10, 0.08, 0.05)  # half the edges of the box that carries the payload [m]

WHEELS = ("front_left", "front_right", "rear_left", "rear_right")
BUILT_IN = "dynabot"  # the robot of this project, by name in place of a file


@dataclass(frozen=True, kw_only=True)
class Conditions:
    """Which robot drives, what it carries and what it drives on."""

    model: str = BUILT_IN  # or the path of another MJCF file with the same names
    payload: float = 0.0  # mass of a box on the middle of the hull's top [kg]
    slope: float = 0.0  # rise of the ground per metre toward +x
    friction: float | None = None  # coefficient of tyre and ground; None: the model's


NOMINAL = Conditions()


@dataclass(frozen=True, kw_only=True)
class Robot:
    """One robot as the compiled model has it; the MJCF is the only place that states its numbers."""

    vehicle: Vehicle
    height: float  # of the chassis' origin when the robot rests on its tyres [m]
    orientation: tuple[float, float, float, float]  # of the chassis then, a quaternion without yaw


def prefix(robot: int) -> str:
    """Returns what the names of a robot's parts begin with in a composed model."""
    return f"r{robot}/"


def compose(robots: int, conditions: Conditions = NOMINAL) -> mujoco.MjSpec:
    """Attaches robots to the field, and lets their tyres, and nothing else of them, roll on its floor.

    Each robot gets a contact sensor, `<prefix>hull_contact`, that counts what touches its hull. A slope is gravity
    tilted against a level floor, so that the plane of motion stays z = const.

    Args:
        robots: Number of robots n; they all stand at the origin.
        conditions: Which robots, and on what ground.

    Raises:
        InputError: If the model's file cannot be read or lacks a name.
    """
    field = mujoco.MjSpec.from_file(str(models.path("field.xml")))
    field.copy_during_attach = True
    robot = _load(conditions.model)
    if conditions.payload > 0.0:
        _add_payload(robot, conditions.payload)
    for index in range(robots):
        name = prefix(index)
        field.attach(robot, prefix=name, frame=field.worldbody.add_frame())
        tyre = field.find_default(f"{name}tyre")
        for wheel in WHEELS:
            pair = field.add_pair(tyre, geomname1="floor", geomname2=f"{name}{wheel}_tyre")
            if conditions.friction is not None:
                pair.friction[:2] = conditions.friction
        field.add_sensor(
            name=f"{name}hull_contact",
            type=mujoco.mjtSensor.mjSENS_CONTACT,
            objtype=mujoco.mjtObj.mjOBJ_GEOM,
            objname=f"{name}hull",
            intprm=[1 << int(mujoco.mjtConDataField.mjCONDATA_FOUND), 0, 1],
        )
    steepness = math.atan(conditions.slope)
    g = float(np.linalg.norm(field.option.gravity))
    field.option.gravity = [-g * math.sin(steepness), 0.0, -g * math.cos(steepness)]
    return field


def compose_tethered(conditions: Conditions = NOMINAL) -> mujoco.MjSpec:
    """Ties one robot's front to a post at the origin, which stands in the leader's place.

    The tether has a sensor, `tether_force`, of what it pulls with.

    Args:
        conditions: Which robot, and on what ground.

    Raises:
        InputError: If the model's file cannot be read or lacks a name.
    """
    field = compose(1, conditions)
    field.delete(field.body("leader"))
    name = "tether/"
    post = mujoco.MjSpec.from_file(str(models.path("tether.xml")))
    field.attach(post, prefix=name, frame=field.worldbody.add_frame())
    tether = field.find_default(f"{name}tether")
    field.joint(f"{prefix(0)}free").parent.add_site(tether, name=f"{name}hitch")
    tendon = field.add_tendon(tether, name=f"{name}tether")
    tendon.wrap_site(f"{name}eye")
    tendon.wrap_site(f"{name}hitch")
    field.add_sensor(
        name="tether_force",
        type=mujoco.mjtSensor.mjSENS_TENDONLIMITFRC,
        objtype=mujoco.mjtObj.mjOBJ_TENDON,
        objname=f"{name}tether",
    )
    return field


@functools.cache
def read_robot(conditions: Conditions = NOMINAL) -> Robot:
    """Compiles a field with one robot, lets it come to rest on its tyres and reads its parameters.

    Raises:
        InputError: If the model's file cannot be read, lacks a name or cannot be a robot.
    """
    name = prefix(0)
    # On the level: held by its motors on a slope, it would rest no differently but for its tilt.
    model = compose(1, Conditions(model=conditions.model, payload=conditions.payload, friction=conditions.friction))
    model = _compiled(model, conditions.model)
    data = mujoco.MjData(model)
    for _ in range(round(_SETTLING_TIME / model.opt.timestep)):
        mujoco.mj_step(model, data)
    joints = [model.joint(name + wheel) for wheel in WHEELS]
    bodies = [int(joint.bodyid[0]) for joint in joints]
    axles = model.body_pos[bodies]
    chassis = int(model.joint(f"{name}free").bodyid[0])
    centre = data.subtree_com[chassis]
    wheel_inertia = float(model.dof_M0[joints[0].dofadr[0]])
    hull = model.geom(f"{name}hull").size
    tyre = model.geom(f"{name}{WHEELS[0]}_tyre").id
    motor = model.actuator(name + WHEELS[0])
    vehicle = Vehicle(
        mass=float(model.body_subtreemass[chassis]),
        yaw_inertia=_yaw_inertia(model, data, chassis),
        mass_centre_height=float(centre[2]),
        mass_centre_forward=float(centre[0] - data.xpos[chassis, 0]),
        wheel_inertia=wheel_inertia,
        wheel_damping=float(model.dof_damping[joints[0].dofadr[0]]),
        # The field's floor is at height zero; contact is made half-way between it and the tyre's undeformed outline.
        wheel_radius=float(data.xpos[bodies[0], 2] + model.geom_size[tyre, 0]) / 2.0,
        track=float(np.ptp(axles[:, 1])),
        wheelbase=float(np.ptp(axles[:, 0])),
        length=2.0 * float(hull[0]),
        breadth=2.0 * float(hull[1]),
        margin=float(model.geom(f"{name}hull").margin[0]),
        friction=float(model.pair_friction[model.pair_geom2.tolist().index(tyre), 0]),
        # As MuJoCo stores a dcmotor: resistance, motor constant; at 6 and 7 the speed loop's gain and the voltage.
        resistance=float(motor.gainprm[0]),
        torque_constant=float(motor.gainprm[1]),
        voltage=float(motor.gainprm[7]),
        torque_limit=float(motor.forcerange[1]),
        servo_gain=float(motor.gainprm[6]),
    )
    pose = data.joint(f"{name}free").qpos
    if data.ncon != len(WHEELS):
        raise InputError(f"the model {conditions.model} does not come to rest on its four tyres")
    return Robot(vehicle=vehicle, height=float(pose[2]), orientation=tuple(pose[3:7].tolist()))


def path(model: str) -> Path:
    """Returns the file of a robot, the built-in one's or another's.

    Raises:
        InputError: If there is no such file.
    """
    file = models.path("dynabot.xml") if model == BUILT_IN else Path(model)
    if not os.path.isfile(file):  # of a path that cannot be one too, which `Path.is_file` raises an error for
        raise InputError(f"model {model!r} given, it must be {BUILT_IN!r} or an MJCF file")
    return file


def _load(model: str) -> mujoco.MjSpec:
    """Reads one robot and makes sure that it has the parts that everything else refers to by name."""
    try:
        robot = mujoco.MjSpec.from_file(str(path(model)))
        # Names that are not UTF-8 are found here only.
        joints, actuators, geoms = ([part.name for part in of] for of in (robot.joints, robot.actuators, robot.geoms))
    except (ValueError, mujoco.FatalError) as error:
        raise InputError(f"the model {model} cannot be read: {' '.join(str(error).split())}") from error
    parts = {
        "joint": (joints, ["free", *WHEELS]),
        "actuator": (actuators, list(WHEELS)),
        "geom": (geoms, ["hull", *(f"{wheel}_tyre" for wheel in WHEELS)]),
    }
    for kind, (names, needed) in parts.items():
        for name in needed:
            if name not in names:
                raise InputError(f"the model {model} has no {kind} named {name!r}; it needs {', '.join(needed)}")
        # Coordinates and controls are read and written by their places.
        if kind != "geom" and names != needed:
            raise InputError(
                f"the model {model} has the {kind}s {', '.join(names)}; it needs {', '.join(needed)}, in this order"
            )
    if robot.find_default("tyre") is None:
        raise InputError(f"the model {model} has no default class named 'tyre', whose <pair> is the tyres' contact")
    return robot


def _compiled(spec: mujoco.MjSpec, model: str) -> mujoco.MjModel:
    try:
        compiled = spec.compile()
    except ValueError as error:
        raise InputError(f"the model {model} cannot be compiled: {' '.join(str(error).split())}") from error
    motors = {compiled.actuator(index).name for index in range(compiled.nactuator)}
    for wheel in WHEELS:
        # What refers to nothing in the robot is left out when it is attached.
        if prefix(0) + wheel not in motors:
            raise InputError(f"the model {model}: actuator {wheel!r} moves no joint of the robot")
        motor = compiled.actuator(prefix(0) + wheel)
        dc_motor = compiled.actuator_gaintype[motor.id] == mujoco.mjtGain.mjGAIN_DCMOTOR
        if not dc_motor or compiled.actuator_ctrlnum[motor.id] != 2:
            raise InputError(f'the model {model}: actuator {wheel!r} must be a dcmotor with input="vel ff"')
    return compiled


def _add_payload(robot: mujoco.MjSpec, mass: float) -> None:
    """Fixes a box of the payload's mass on the middle of the hull's top."""
    hull = robot.geom("hull")
    top = hull.pos + np.array([0.0, 0.0, hull.size[2] + _PAYLOAD_SIZE[2]])
    body = hull.parent.add_body(name="payload", pos=top)
    body.add_geom(
        name="payload",
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=_PAYLOAD_SIZE,
        mass=mass,
        contype=0,
        conaffinity=0,
        group=1,
        rgba=[0.65, 0.50, 0.30, 1.0],
    )


def _yaw_inertia(model: mujoco.MjModel, data: mujoco.MjData, chassis: int) -> float:
    """Returns the inertia of a robot about the vertical through its centre of mass [kg m^2]."""
    total, centre = 0.0, data.subtree_com[chassis]
    for body in range(model.nbody):
        if model.body_rootid[body] == chassis:
            axes = data.ximat[body].reshape(3, 3)
            own = axes[2] ** 2 @ model.body_inertia[body]
            total += float(own + model.body_mass[body] * np.sum((data.xipos[body] - centre)[:2] ** 2))
    return total
