"""Estimators by name: those of `dynabot_mj.perception.methods`, and those of the user's, `my_module:MyFilter`."""

import importlib
import math
from pathlib import Path
from typing import Any, Literal, get_args

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.estimation.estimator import Estimator, Filter
from dynabot_mj.estimation.parameters import DEFAULT, Parameters
from dynabot_mj.host import user_code
from dynabot_mj.perception.methods import METHODS
from dynabot_mj.perception.own_filter import METHODS_OF_A_FILTER, CheckedFilter

Implementation = Literal["batched", "filterpy"]

NAMES = tuple(name for name, record in METHODS.items() if record.filter)
IMPLEMENTATIONS: tuple[Implementation, ...] = get_args(Implementation)


def build(
    name: str,
    shape: tuple[int, ...],
    parameters: Parameters = DEFAULT,
    implementation: Implementation = "batched",
    own: str | None = None,
) -> Estimator:
    """Returns an estimator for robots in an arrangement of leading axes.

    Args:
        name: Of the method.
        shape: Leading axes of the samples, e.g. (trials, robots).
        parameters: Assumed errors.
        implementation: All robots at once, or FilterPy's filters one robot at a time.
        own: `my_module:MyFilter` of a method of the user's; None: the method is built in.

    Raises:
        InputError: If a filter of the user's cannot be had, or is none; from the estimator, where it fails.

    Example:
        >>> dy.build_estimator("coupled", (10, 3)).filter.beliefs()["position_w"].shape  # of 10 trials x 3 robots
        (30, 2)
    """
    count = math.prod(shape)
    if own is not None:
        return Estimator(_own(name, own, count, parameters), shape, parameters)
    record = METHODS[name]
    if implementation == "batched":
        return Estimator(_class(record.filter)(count, parameters), shape, parameters)
    # FilterPy takes a second to import, and most uses do without it.
    from dynabot_mj.estimation.robot_by_robot import FullStateRobotByRobot, RobotByRobot

    twins = [twin(name, parameters) for _ in range(count)]
    together = FullStateRobotByRobot if hasattr(twins[0], "moments") else RobotByRobot
    return Estimator(together(twins), shape, parameters)


def twin(name: str, parameters: Parameters = DEFAULT) -> Any:
    """Returns a built-in filter of one robot on FilterPy."""
    return _class(METHODS[name].twin)(parameters)


def has_twin(name: str) -> bool:
    """Tells whether a method has a filter on FilterPy beside its own."""
    return name in METHODS and METHODS[name].twin is not None


def source(name: str, own: str) -> Path | None:
    """Returns the file of a filter of the user's; None where there is no file.

    Raises:
        InputError: If there is no such filter.
    """
    return user_code.source(_load(name, own))


def _class(path: str | None) -> Any:
    """Returns the class of a built-in filter, whose module is imported only now."""
    assert path is not None  # whoever knows the truth has no filter
    module, _, name = path.partition(":")
    return getattr(importlib.import_module(module), name)


def _load(name: str, own: str) -> Any:
    found = user_code.load(f"method.{name}.filter = {own!r}", own, "my_module:MyFilter", "a class")
    if missing := [one for one in METHODS_OF_A_FILTER if not callable(getattr(found, one, None))]:
        raise InputError(
            f"method.{name}.filter = {own!r} given, it has no {', '.join(missing)}: see docs/own-estimator.md"
        )
    return found


def _own(name: str, own: str, count: int, parameters: Parameters) -> Filter:
    made = _load(name, own)
    with user_code.called(f"method {name}: {own.partition(':')[2]} cannot be made"):
        filter_ = made(count, parameters)
    return CheckedFilter(name, filter_, count)
