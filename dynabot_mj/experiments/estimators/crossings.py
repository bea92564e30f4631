"""Whether innovations of the heading are wrapped: errors where the bearing jumps, beside those elsewhere.

Bearings jump at +-180 degrees, once in each lap.
"""

import math
from dataclasses import dataclass

import numpy as np

from dynabot_mj.common.arrays import Array, rms
from dynabot_mj.estimation.measurements import wrap
from dynabot_mj.experiments.estimators.troubles import BEGIN
from dynabot_mj.sensing.ground_truth import GroundTruth

NEAR = math.radians(15.0)  # of +-180 degrees
SETTLED = 0.5 * BEGIN  # from when errors are judged [s]


@dataclass(frozen=True, kw_only=True)
class Crossing:
    """RMS and largest errors where the bearing jumps, and elsewhere."""

    estimator: str
    crossings: int
    near_heading_deg: float
    far_heading_deg: float
    near_largest_heading_deg: float
    far_largest_heading_deg: float
    near_position_m: float  # RMS per axis
    far_position_m: float


def crossing(name: str, truth: GroundTruth, position: Array, heading: Array) -> Crossing:
    """Judges an estimator by its errors.

    Args:
        name: Of the estimator.
        truth: At N times of R runs.
        position: Its errors, (N, R), not negative [m].
        heading: The same of the heading, (N, R) [rad].
    """
    settled = truth.time >= SETTLED
    around = wrap(truth.heading[settled] - math.pi)
    near = np.abs(around) < NEAR
    heading, position = np.degrees(heading[settled]), position[settled]
    return Crossing(
        estimator=name,
        crossings=int(((around[:-1] < 0.0) & (around[1:] >= 0.0)).sum()),
        near_heading_deg=float(rms(heading[near])),
        far_heading_deg=float(rms(heading[~near])),
        near_largest_heading_deg=float(heading[near].max()),
        far_largest_heading_deg=float(heading[~near].max()),
        near_position_m=float(rms(position[near])) / math.sqrt(2.0),
        far_position_m=float(rms(position[~near])) / math.sqrt(2.0),
    )
