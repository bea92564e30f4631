"""What the checks of the filters have in common: drives on the circle, and what the sensors say on them."""

from dataclasses import dataclass

import numpy as np

from dynabot_mj.experiments.estimators import kinematic
from dynabot_mj.sensing import replay
from dynabot_mj.sensing.ground_truth import GroundTruth
from dynabot_mj.sensing.options import SensorOptions

PERIOD = 0.036  # T_s, that of the decoupled EKF in Table III [s]
LAP = 2.0 * np.pi * kinematic.RADIUS / kinematic.SPEED  # time that a lap takes [s]
_LOOKS = 4  # in a sampling period; fixes are true in between


@dataclass(frozen=True, kw_only=True)
class Drives:
    """R drives around the circle, and what sensors said of them."""

    truth: GroundTruth  # at the times of the samples
    samples: replay.Samples  # (N, R, ...)


def drive(options: SensorOptions, runs: int, seed: int, duration: float) -> Drives:
    """Drives around the circle.

    Args:
        options: Errors of the sensors.
        runs: R.
        seed: Of paths and errors.
        duration: With the rest at the beginning [s].
    """
    fine = kinematic.follow("circle", runs, seed, duration, PERIOD / _LOOKS)
    samples = replay.record(fine, options, PERIOD, seed)
    return Drives(truth=fine.thinned(_LOOKS), samples=samples)
