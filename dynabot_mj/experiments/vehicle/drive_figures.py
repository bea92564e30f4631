"""What the acceptance drive measures, read off the traces of its manoeuvres.

The theory of the turn in place is that of Coulomb friction under sliding tyres, 2 R omega T / (T^2 + L^2), with track
T, wheelbase L and the wheels' measured speed omega.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dynabot_mj.common.arrays import Array
from dynabot_mj.controllers.vehicle import GRAVITY
from dynabot_mj.experiments.vehicle.drives import COLLISION_SPEED, ROLLING_SPEED, SLOPES, TURN_SPEEDS, Drives
from dynabot_mj.experiments.vehicle.proving_ground import ProvingGround, Trace
from dynabot_mj.plants import scene
from dynabot_mj.plants.scene import Robot

PEAK_WINDOW = 0.02  # over which a peak is averaged; a whole number of each step size up to 5 ms [s]
SPUN_OUT = math.radians(45.0)  # side slip beyond which a vehicle no longer corners
ENERGY_GAIN = 1e-6  # in one step, that counts [J]
HELD_CREEP = 1e-3  # slower than this counts as held [m/s]


@dataclass(frozen=True, kw_only=True)
class Corner:
    """A turn under a constant difference of the wheels' commands, without yaw feedback."""

    speed_mps: float  # commanded, ahead
    wheel_difference_radps: float  # commanded, right minus left
    radius_m: float | None  # of the path of the centre in the last third; null: it spun out
    side_slip_deg: float  # largest
    spun_out: bool


@dataclass(frozen=True, kw_only=True)
class Collision:
    """Two robots head-on; the worst of several phases of the physics steps at which the hulls meet."""

    closing_speed_mps: float
    overlap_m: float  # of the hulls
    rise_m: float  # of a chassis
    rebound_mps: float  # closing speed after the collision; negative: they part
    momentum_error: float  # sum of m v, by what each of the two brings in


@dataclass(frozen=True, kw_only=True)
class Figures:
    """What the drive measures; the names are the keys of the JSON document."""

    mass_kg: float
    friction: float
    timestep_ms: float
    rolling_radius_m: float  # way by wheel angle, coasting
    top_speed_mps: float
    time_to_95_percent_s: float  # of the top speed, from rest
    peak_acceleration_g: float  # over 20 ms
    mean_acceleration_g: float  # up to 95 % of the top speed
    braking_distance_m: float  # from 5 m/s, wheels commanded to stand
    braking_time_s: float | None
    peak_deceleration_g: float  # over 20 ms
    coasting_distance_m: float | None  # from 5 to 2.5 m/s, motors off
    coasting_time_s: float | None
    turn_rate_over_theory: dict[str, float]  # by commanded wheel speed [rad/s]; the worse of the two signs
    heading_spread: float  # (max - min) / mean of the yaw rate over initial headings
    drift_mm_per_m: float  # sideways, driving straight
    airborne_fraction: float  # of the steps of all manoeuvres: a tyre is off the floor
    airborne_fraction_gripping: float  # the same without the corners in which it spun out
    energy_gain_steps: int  # of the free slides, with a gain of kinetic and potential energy
    largest_energy_gain_j: float  # in one of their steps; negative: every step loses
    slope_creep_mmps: dict[str, float]  # by rise per metre; facing uphill, wheels commanded to stand
    slope_creep_across_mmps: dict[str, float]  # the same, standing across the slope
    largest_slope_held: float | None  # on which it creeps less than 1 mm/s, of those tried
    largest_slope_braked: float | None  # on which the creep is steady, of those tried
    launch_current_a: float  # of a motor, largest
    launch_voltage_v: float
    top_speed_current_a: float
    top_speed_voltage_v: float
    cornering: tuple[Corner, ...]
    collision: Collision
    warnings: int  # of MuJoCo, in all manoeuvres


def read(ground: ProvingGround, drives: Drives, energies: Sequence[Array], timestep: float) -> Figures:
    """Reads the figures off the traces.

    Args:
        ground: On which they were driven.
        drives: The traces.
        energies: Of each of the free slides, (T,) [J].
        timestep: Of the physics [s].
    """
    return Figures(
        mass_kg=ground.robot.vehicle.mass,
        friction=ground.robot.vehicle.friction,
        timestep_ms=1e3 * timestep,
        warnings=sum(trace.warnings for trace in drives.all()),
        energy_gain_steps=sum(int((np.diff(energy) > ENERGY_GAIN).sum()) for energy in energies),
        largest_energy_gain_j=max(float(np.diff(energy).max()) for energy in energies),
        turn_rate_over_theory=_turning(ground.robot, drives.turns),
        heading_spread=_spread([_late(trace.yaw_rate) for trace in drives.headings]),
        cornering=tuple(_corner(*asked, trace) for asked, trace in drives.corners.items()),
        collision=_collision(ground.robot, drives.collisions),
        **_straight(drives.launch),
        **_stopping(drives.brake, drives.coast),
        **_airborne(drives),
        **_slopes(drives.uphill, drives.across),
        **_motors(ground.robot, drives.launch),
    )


def _straight(launch: Trace) -> dict[str, Any]:
    speed = launch.velocity_b[:, 0, 0]
    # Between samples, so that the figure does not come in whole steps.
    reached = _when(launch.time, speed, 0.95 * speed[-1])
    assert reached is not None  # the speed's last value is above
    return {
        "top_speed_mps": float(speed[-1]),
        "time_to_95_percent_s": reached,
        "peak_acceleration_g": _peak(speed, launch.time),
        "mean_acceleration_g": float(0.95 * speed[-1] / reached / GRAVITY),
        "drift_mm_per_m": float(1e3 * np.abs(launch.sideways).max() / launch.forward[-1, 0]),
    }


def _stopping(brake: Trace, coast: Trace) -> dict[str, Any]:
    speed, coasting = brake.velocity_b[:, 0, 0], coast.velocity_b[:, 0, 0]
    angle = coast.qpos[-1, 0, 7:] - coast.qpos[0, 0, 7:]
    half = _when(coast.time, -coasting, -ROLLING_SPEED / 2.0)
    return {
        "rolling_radius_m": float(coast.forward[-1, 0] / angle.mean()),
        "braking_distance_m": float(brake.forward[-1, 0]),
        "braking_time_s": _when(brake.time, -speed, -0.01),
        "peak_deceleration_g": _peak(-speed, brake.time),
        "coasting_time_s": half,
        "coasting_distance_m": None if half is None else float(np.interp(half, coast.time, coast.forward[:, 0])),
    }


def _turning(robot: Robot, turns: Mapping[float, Trace]) -> dict[str, float]:
    """Returns yaw rate over theory by commanded wheel speed, of the sign for which it is farther from one."""
    vehicle, found = robot.vehicle, {}
    for command in TURN_SPEEDS:
        ratios = []
        for sign in (1.0, -1.0):
            trace = turns[sign * command]
            wheel = _late(np.abs(trace.wheel_speed).mean(axis=-1))
            ratios.append(sign * _late(trace.yaw_rate) / (2.0 * vehicle.wheel_radius * wheel / vehicle.turning_track))
        found[f"{command:g}"] = max(ratios, key=lambda ratio: abs(ratio - 1.0))
    return found


def _corner(speed: float, difference: float, trace: Trace) -> Corner:
    velocity, last = trace.velocity_b[:, 0], len(trace.time) * 2 // 3
    slip = float(np.abs(np.arctan2(velocity[:, 1], velocity[:, 0])).max())
    path = float(np.linalg.norm(velocity[last:], axis=-1).mean())
    return Corner(
        speed_mps=speed,
        wheel_difference_radps=difference,
        radius_m=None if slip > SPUN_OUT else path / abs(float(trace.yaw_rate[last:].mean())),
        side_slip_deg=math.degrees(slip),
        spun_out=slip > SPUN_OUT,
    )


def _airborne(drives: Drives) -> dict[str, Any]:
    spun_out = [trace for asked, trace in drives.corners.items() if _corner(*asked, trace).spun_out]
    everything = drives.all()
    gripping = [trace for trace in everything if all(trace is not other for other in spun_out)]
    shares = []
    for traces in (everything, gripping):
        lifted = [trace.contacts < len(scene.WHEELS) * trace.qpos.shape[1] for trace in traces]
        shares.append(float(np.concatenate(lifted).mean()))
    return {"airborne_fraction": shares[0], "airborne_fraction_gripping": shares[1]}


def _slopes(uphill: Mapping[float, Trace], across: Mapping[float, Trace]) -> dict[str, Any]:
    creep = {slope: _late(np.linalg.norm(trace.velocity_b, axis=-1)) for slope, trace in uphill.items()}
    held = [slope for slope, speed in creep.items() if speed < HELD_CREEP]
    braked = [slope for slope, trace in uphill.items() if _is_steady(np.linalg.norm(trace.velocity_b, axis=-1))]
    return {
        "slope_creep_mmps": {f"{slope:g}": 1e3 * creep[slope] for slope in SLOPES},
        "slope_creep_across_mmps": {
            f"{slope:g}": 1e3 * _late(np.linalg.norm(trace.velocity_b, axis=-1)) for slope, trace in across.items()
        },
        "largest_slope_held": max(held, default=None),
        "largest_slope_braked": max(braked, default=None),
    }


def _motors(robot: Robot, launch: Trace) -> dict[str, Any]:
    current = np.abs(launch.torque) / robot.vehicle.torque_constant
    voltage = np.abs(
        robot.vehicle.resistance * launch.torque / robot.vehicle.torque_constant
        + robot.vehicle.torque_constant * launch.wheel_speed
    )
    return {
        "launch_current_a": float(current.max()),
        "launch_voltage_v": float(voltage.max()),
        "top_speed_current_a": float(current[-1].mean()),
        "top_speed_voltage_v": float(voltage[-1].mean()),
    }


def _collision(robot: Robot, traces: Sequence[Trace]) -> Collision:
    last = [trace.qvel[-1, 0, 0] - trace.qvel[-1, 1, 0] for trace in traces]
    before = [trace.qvel[trace.touched, :, 0] for trace in traces]
    return Collision(
        closing_speed_mps=float(np.mean([one - other for one, other in before])),
        overlap_m=max(0.0, *(float(trace.overlap.max()) for trace in traces)),
        rise_m=max(float(trace.qpos[..., 2].max()) - robot.height for trace in traces),
        rebound_mps=float(min(last)),
        momentum_error=max(float(np.abs(trace.qvel[..., 0].sum(axis=1)).max()) for trace in traces) / COLLISION_SPEED,
    )


def _peak(speed: Array, time: Array) -> float:
    """Returns the largest rise of a speed over a window of fixed length, whatever the step [g]."""
    steps = max(1, round(PEAK_WINDOW / time[1]))
    return float((speed[steps:] - speed[:-steps]).max() / (steps * time[1]) / GRAVITY)


def _late(values: Array) -> float:
    """Returns the mean over the second half of a manoeuvre of one robot."""
    return float(values[len(values) // 2 :].mean())


def _is_steady(speed: Array) -> bool:
    """Says whether a speed grows by less than 1 % in the last quarter of a manoeuvre of one robot."""
    return float(speed[-1, 0]) < 1.01 * float(speed[len(speed) * 3 // 4, 0])


def _spread(values: Sequence[float]) -> float:
    return (max(values) - min(values)) / abs(float(np.mean(values)))


def _when(time: Array, values: Array, level: float) -> float | None:
    """Returns when a rising quantity reaches a level, between the samples; None if it does not."""
    later = int(np.argmax(values >= level))
    if values[later] < level:
        return None
    if later == 0:
        return float(time[0])
    return float(np.interp(level, values[later - 1 : later + 1], time[later - 1 : later + 1]))
