"""The paper's tether experiment (Sec. III.B): a robot is driven around a post while its sensors are recorded.

A run begins at rest, the tether just slack and the heading along the tangent, so that estimators can find their biases
and their bearing. Then the robot accelerates and circles counter-clockwise. The local law asks for less yaw rate than
the circle has: the robot pulls outward, and the tether, tied to its nose, steers it. Nothing but the friction of the
ground and the bearing of the start differs between runs; what else does is up to the sensors.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from mujoco import batch

from dynabot_mj.common.arrays import Array, Progress
from dynabot_mj.common.exceptions import DynabotError
from dynabot_mj.common.streams import Purpose, generators
from dynabot_mj.controllers import gains, traction
from dynabot_mj.controllers.steering import Motion
from dynabot_mj.plants import free_joint, scene
from dynabot_mj.sensing.ground_truth import GroundTruth

INTERVAL = 0.009  # of the recording [s]
DURATION = 100.0  # of a run, of the same length as the one that the paper's estimates were judged on [s]

_LOCAL_PERIOD = 0.036  # of the local law [s]
_PHYSICS_STEP = 0.0045  # [s]
_RECORDED = round(INTERVAL / _PHYSICS_STEP)  # one physics step in so many
_SLACK = 0.01  # by which the start is nearer to the post than the taut tether lets it be [m]
_FRICTION = (0.6, 0.9)  # of tyres and ground, the least and the most
_CHUNK = 25  # runs stepped at once; their physics steps are kept until they are through


@dataclass(frozen=True, kw_only=True)
class Profile:
    """How the robot is told to drive."""

    rest: float = 4.0  # before it starts [s]
    acceleration: float = 1.0  # then [m/s^2]
    speed: float = 3.0  # at last [m/s]
    turning: float = 0.75  # share of the circle's yaw rate that is asked for; the tether sees to the others

    def motion(self, time: float, radius: float, runs: int) -> Motion:
        """Returns what the traction law is asked for.

        Args:
            time: Since the start [s].
            radius: Of the circle [m].
            runs: Number of runs R.
        """
        wanted = self.acceleration * (time - self.rest)
        speed = min(max(wanted, 0.0), self.speed)
        return Motion(
            speed=np.full(runs, speed),
            acceleration=np.full(runs, self.acceleration if 0.0 <= wanted < self.speed else 0.0),
            yaw_rate=np.full(runs, self.turning * speed / radius),
        )


PROFILE = Profile()


@dataclass(frozen=True, kw_only=True)
class _Trace:
    """What MuJoCo did in R runs at K times."""

    qpos: Array  # (K, R, 11): position, orientation, wheel angles [m, -, rad]
    qvel: Array  # (K, R, 10): velocity in the world, angular velocity in the body, wheel speeds [m/s, rad/s]
    torque: Array  # of the motors in the step before, (K, R, 4) [Nm]
    gravity_w: Array  # (3,) [m/s^2]


def drive(
    runs: Sequence[int],
    seed: int,
    duration: float = DURATION,
    *,
    profile: Profile = PROFILE,
    threads: int = 1,
    progress: Progress | None = None,
) -> GroundTruth:
    """Drives around the post.

    Args:
        runs: Their numbers, length R. What a run draws depends on the seed and its number alone.
        seed: Of friction and start.
        duration: Of each run, rounded up to whole periods of the local law [s].
        profile: How to drive.
        threads: Of MuJoCo; they change the speed, never the result.
        progress: Told the share of the work that is done.

    Raises:
        DynabotError: If MuJoCo warns, of a NaN, a huge value or of too little memory.
    """
    # MuJoCo would print its warnings and append them to a file in the working directory; they are looked at below.
    mujoco.set_mju_user_warning(lambda message: None)
    periods = math.ceil(duration / _LOCAL_PERIOD - 1e-9)
    whole: dict[str, Array] = {}
    for first in range(0, len(runs), _CHUNK):
        part = slice(first, first + _CHUNK)
        for name, values in _truth(_run(runs[part], seed, periods, profile, threads)).items():
            whole.setdefault(name, np.empty((len(values), len(runs), *values.shape[2:])))[:, part] = values
        if progress is not None:
            progress(min(first + _CHUNK, len(runs)) / len(runs))
    return GroundTruth(time=INTERVAL * np.arange(len(whole["heading"]), dtype=np.float64), **whole)


def _run(runs: Sequence[int], seed: int, periods: int, profile: Profile, threads: int) -> _Trace:
    """Steps some runs through their periods of the local law."""
    model = scene.compose_tethered().compile()
    model.opt.timestep = _PHYSICS_STEP
    vehicle, law = scene.read_robot().vehicle, gains.load("tuned").traction
    radius = _taut_radius(model)
    simulations = batch.Batch(model, nsim=len(runs), nthread=threads)
    friction = simulations.expand("pair_friction").reshape(len(runs), model.npair, -1)
    friction[..., :2] = _uniform(seed, runs, Purpose.FRICTION, _FRICTION)[:, None, None]
    qpos, qvel = simulations.bind("qpos"), simulations.bind("qvel")
    ctrl = simulations.bind("ctrl").reshape(len(runs), len(scene.WHEELS), 2)
    _place(qpos, _uniform(seed, runs, Purpose.START, (0.0, 2.0 * math.pi)), radius - _SLACK)
    substeps = round(_LOCAL_PERIOD / _PHYSICS_STEP)
    each = substeps // _RECORDED
    trace = _Trace(
        qpos=np.empty((periods * each + 1, *qpos.shape)),
        qvel=np.empty((periods * each + 1, *qvel.shape)),
        torque=np.zeros((periods * each + 1, len(runs), model.nactuator)),
        gravity_w=model.opt.gravity.copy(),
    )
    trace.qpos[0], trace.qvel[0] = qpos, qvel
    for period in range(periods):
        speed, yaw_rate = _sensed(qpos, qvel)
        motion = profile.motion(period * _LOCAL_PERIOD, radius, len(runs))
        ctrl[..., 0], ctrl[..., 1] = traction.drive(motion, speed, yaw_rate, vehicle=vehicle, gains=law)
        steps = simulations.rollout(substeps, record=["qpos", "qvel", "actuator_force"])
        now = slice(period * each + 1, (period + 1) * each + 1)
        for name, into in (("qpos", trace.qpos), ("qvel", trace.qvel), ("actuator_force", trace.torque)):
            into[now] = steps[name][:, _RECORDED - 1 :: _RECORDED].swapaxes(0, 1)
    if simulations.warning[..., 1].any():
        raise DynabotError(f"seed {seed}: MuJoCo met a NaN, a huge value or too many contacts among the runs {runs}")
    return trace


def _taut_radius(model: mujoco.MjModel) -> float:
    """Returns the radius at which a robot that faces along the tangent has the tether taut [m]."""
    ahead, left, _ = model.site("tether/hitch").pos
    length = model.tendon_range[model.tendon("tether/tether").id, 1]
    return float(math.sqrt(length**2 - ahead**2) + left)


def _uniform(seed: int, runs: Sequence[int], purpose: Purpose, limits: tuple[float, float]) -> Array:
    """Returns a number between two limits for each run, (R,)."""
    low, high = limits
    return np.array([low + (high - low) * generator.random() for generator in generators(seed, runs, purpose)])


def _place(qpos: Array, bearing: Array, radius: float) -> None:
    """Puts the robots at rest on their tyres, facing along the tangent.

    Args:
        qpos: Their coordinates, which are written, (R, 11).
        bearing: From the post, (R,) [rad].
        radius: About the post [m].
    """
    robot = scene.read_robot()
    qpos[:, 0], qpos[:, 1], qpos[:, 2] = radius * np.cos(bearing), radius * np.sin(bearing), robot.height
    qpos[:, 3:7] = free_joint.turned(bearing + math.pi / 2.0, np.array(robot.orientation))


def _sensed(qpos: Array, qvel: Array) -> tuple[Array, Array]:
    """Returns the true forward speed and yaw rate, (R,) [m/s], [rad/s]."""
    orientation = free_joint.orientation(qpos[:, 3:7].T)
    yaw = orientation.yaw
    return qvel[:, 0] * np.cos(yaw) + qvel[:, 1] * np.sin(yaw), orientation.yaw_rate(qvel[:, 3:6].T)


def _truth(trace: _Trace) -> dict[str, Array]:
    """Returns the fields of `GroundTruth` but for the time, each (K, R, ...)."""
    orientation = free_joint.orientation(np.moveaxis(trace.qpos[..., 3:7], -1, 0))
    axes_w = orientation.horizontal_w
    felt_b = free_joint.felt_increment_b(
        0.5 * (axes_w[:, :, :-1] + axes_w[:, :, 1:]),
        np.moveaxis(np.diff(trace.qvel[..., :3], axis=0), -1, 0),
        INTERVAL,
        trace.gravity_w[:, None, None],
    )
    return {
        "position_w": trace.qpos[..., :2],
        "velocity_w": trace.qvel[..., :2],
        "heading": np.unwrap(orientation.yaw, axis=0),
        "yaw_rate": orientation.yaw_rate(np.moveaxis(trace.qvel[..., 3:6], -1, 0)),
        "velocity_increment_b": np.pad(np.moveaxis(felt_b.cumsum(axis=1), 0, -1), ((1, 0), (0, 0), (0, 0))),
        "wheel_speed": trace.qvel[..., 6:],
        "motor_current": trace.torque / scene.read_robot().vehicle.torque_constant,
    }
