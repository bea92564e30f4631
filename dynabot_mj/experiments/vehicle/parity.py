"""The tuning's design model beside MuJoCo, under the same motor commands."""

from dataclasses import dataclass

import numpy as np

from dynabot_mj.common.arrays import Array, rms
from dynabot_mj.controllers.design import planar_model
from dynabot_mj.experiments.vehicle.proving_ground import TURNING, ProvingGround
from dynabot_mj.plants import scene


@dataclass(frozen=True, kw_only=True)
class Parity:
    """The design model beside MuJoCo under the same motor commands, manoeuvre after manoeuvre."""

    names: tuple[str, ...]  # of the manoeuvres
    end: Array  # of each manoeuvre on the common time axis [s]
    time: Array  # (K,) [s]
    signals: tuple[str, ...]  # with their units
    mujoco: Array  # (K, signals)
    planar: Array  # (K, signals)

    @property
    def error(self) -> Array:
        """RMS difference of each signal by its range in MuJoCo, (signals,)."""
        return rms(self.mujoco - self.planar, axis=0) / np.ptp(self.mujoco, axis=0)


def parity(conditions: scene.Conditions = scene.NOMINAL) -> Parity:
    """Drives the acceptance course with both models.

    Args:
        conditions: Which robot, its payload and the friction.
    """
    step = 0.005
    ground, vehicle = ProvingGround(conditions, step), scene.read_robot(conditions).vehicle
    drives: dict[str, tuple[float, float, Array, float]] = {
        "launch": (4.0, 0.0, np.full(4, 200.0), 2.0),
        "brake": (1.5, 5.0, np.zeros(4), 0.0),
        "turn left": (1.5, 0.0, 20.0 * TURNING, 0.0),
        "turn right": (1.5, 0.0, -40.0 * TURNING, 0.0),
    }
    for speed, difference in ((2.0, 10.0), (3.0, 10.0), (4.0, 10.0), (2.0, 20.0)):
        command = speed / vehicle.wheel_radius + difference / 2.0 * TURNING
        drives[f"corner {speed:g} m/s, {difference:g} rad/s"] = (3.0, speed, command, 0.0)
    ours: list[Array] = []
    theirs: list[Array] = []
    end: list[float] = []
    for duration, speed, command, torque in drives.values():
        trace = ground.run(duration, command, torque, motion=(speed, 0.0, 0.0))
        start = np.array([0.0, 0.0, 0.0, speed, 0.0, 0.0, *[speed / vehicle.wheel_radius] * 4])
        count = len(trace.time)
        states = planar_model.simulate(start, np.tile(command, (count, 1)), np.full((count, 4), torque), step, vehicle)
        states = np.vstack([start, states[:-1]])  # the trace has the states at the beginning of each step
        left, right = states[:, 6:10:2].mean(axis=-1), states[:, 7:10:2].mean(axis=-1)
        ours.append(np.column_stack([states[:, 3:6], left, right]))
        wheels = trace.wheel_speed[:, 0]
        yaw = np.column_stack([trace.yaw_rate[:, 0], wheels[:, ::2].mean(axis=-1), wheels[:, 1::2].mean(axis=-1)])
        theirs.append(np.column_stack([trace.velocity_b[:, 0], yaw]))
        end.append((end[-1] if end else 0.0) + duration)
    total = sum(map(len, ours))
    return Parity(
        names=tuple(drives),
        end=np.array(end),
        time=step * np.arange(total, dtype=np.float64),
        signals=("speed [m/s]", "side speed [m/s]", "yaw rate [rad/s]", "left wheels [rad/s]", "right wheels [rad/s]"),
        mujoco=np.concatenate(theirs),
        planar=np.concatenate(ours),
    )
