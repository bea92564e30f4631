"""The estimators by name."""

import math
from typing import Literal, get_args

from dynabot_mj.estimation.coupled_ekf import CoupledEkf
from dynabot_mj.estimation.decoupled_ekf import DecoupledEkf
from dynabot_mj.estimation.estimator import Estimator, Filter
from dynabot_mj.estimation.gps_extrapolation import GpsExtrapolation
from dynabot_mj.estimation.parameters import DEFAULT, Parameters
from dynabot_mj.estimation.robot_by_robot import FullStateRobotByRobot, RobotByRobot

Name = Literal["gps", "decoupled", "coupled"]
Implementation = Literal["batched", "filterpy"]

NAMES: tuple[Name, ...] = get_args(Name)
IMPLEMENTATIONS: tuple[Implementation, ...] = get_args(Implementation)


def build(
    name: Name,
    shape: tuple[int, ...],
    parameters: Parameters = DEFAULT,
    implementation: Implementation = "batched",
) -> Estimator:
    """Returns an estimator for robots in an arrangement of leading axes.

    Args:
        name: Of Table II's rows.
        shape: Leading axes of the samples, e.g. (trials, robots).
        parameters: Assumed errors.
        implementation: All robots at once, or FilterPy's filters one robot at a time.

    Example:
        >>> dy.build_estimator("coupled", (10, 3)).filter.beliefs()["position_w"].shape  # of 10 trials x 3 robots
        (30, 2)
    """
    count = math.prod(shape)
    match implementation:
        case "batched":
            found = _batched(name, count, parameters)
        case "filterpy":
            found = _twins(name, count, parameters)
    return Estimator(found, shape, parameters)


def _batched(name: Name, count: int, parameters: Parameters) -> Filter:
    match name:
        case "gps":
            return GpsExtrapolation(count, parameters)
        case "decoupled":
            return DecoupledEkf(count, parameters)
        case "coupled":
            return CoupledEkf(count, parameters)


def _twins(name: Name, count: int, parameters: Parameters) -> Filter:
    # FilterPy takes a second to import, and most uses do without it.
    from dynabot_mj.estimation import filterpy_twins as twins

    match name:
        case "gps":
            return RobotByRobot([twins.GpsExtrapolation(parameters) for _ in range(count)])
        case "decoupled":
            return FullStateRobotByRobot([twins.DecoupledEkf(parameters) for _ in range(count)])
        case "coupled":
            return FullStateRobotByRobot([twins.CoupledEkf(parameters) for _ in range(count)])
