"""What no single value of a configuration shows: values that do not fit together, or are of another unit."""

import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from dynabot_mj.common.exceptions import InputError, suggestion
from dynabot_mj.common.validation import UNITS
from dynabot_mj.controllers.potential_field import polygon_circumradius
from dynabot_mj.formation import laws
from dynabot_mj.perception import estimators
from dynabot_mj.perception import options as perception_options
from dynabot_mj.plants import scene
from dynabot_mj.plants.kinds import KINDS, any_bodies
from dynabot_mj.sensing import options as sensing_options
from dynabot_mj.study import assembly, fleet, methods, scenario
from dynabot_mj.study.scenario import Scenario

# Rise per metre up to which rigid robots with real accelerometers keep to their forces; they ran away from 0.053 on.
_STEEPEST = 0.04
# A value is refused beyond so many times its default, and some below that part of it: a factor of 1,000 in its unit is.
_FAR = 300.0
# In place of defaults that follow from others, or are zero [s], [m], [kg].
_USUAL = {"sample_period": 2.0 / _FAR, "control_period": 2.0 / _FAR, "neighbour_range": 10.0, "mass": 12.0}
_USUAL["payload"] = 100.0 / _FAR
_NEVER_TINY = ("mass", "field.spacing", "field.neighbour_range", "start.distance")


def check(setup: Scenario) -> None:
    """Checks what no single value shows.

    Raises:
        InputError: With the values that do not fit together.
    """
    _check_methods(setup)
    defaults = asdict(Scenario())
    # Methods of the user's are as the decoupled EKF's by default.
    defaults["method"] = {name: defaults["method"].get(name, defaults["method"]["decoupled"]) for name in setup.method}
    _check_sizes(asdict(setup), defaults)
    _check_rows(setup)
    _check_start(setup)
    _check_perception(setup)
    laws.source(setup.controller)
    _check_vehicle(setup)


def _check_methods(setup: Scenario) -> None:
    """Checks that the estimators are methods, and that the user's have filters; see `check`."""
    for name in setup.estimators:
        if name not in setup.method:
            raise InputError(
                f"estimators = {name!r} given, it must be one of {', '.join(setup.method)}, or a method of your own, "
                f"[method.{name}]{suggestion(name, setup.method)}"
            )
    methods.check({name: row for name, row in setup.method.items() if name in setup.estimators or row.filter is None})


def _check_rows(setup: Scenario) -> None:
    """Checks periods, accuracy and wells of each method; see `check`."""
    for estimator in setup.estimators:
        _, control_ticks = scenario.periods(setup, estimator)
        control_period = control_ticks * setup.processor.tick
        if scenario.duration(setup) < control_period:
            raise InputError(
                f"duration = {scenario.duration(setup):g} s given, it must be at least the control period of "
                f"{estimator}, {control_period:g} s"
            )
        uncertainty = scenario.method(setup, estimator).uncertainty
        if (uncertainty == 0.0) != (estimator == "perfect"):
            raise InputError(
                f"method.{estimator}.uncertainty = {uncertainty:g} m given; "
                "it is 0 for perfect and positive for all others"
            )
        wells = assembly.field(setup, estimator)
        for name, well in (("leader_range", wells.leader), ("neighbour_range", wells.neighbour)):
            if well.range <= well.radius + well.width:
                raise InputError(
                    f"field.{name} = {well.range:g} m given, it must be beyond the well's floor, which ends at "
                    f"{well.radius + well.width:g} m"
                )


def _check_start(setup: Scenario) -> None:
    """Checks that robots start apart from each other and within the leader's reach; see `check`."""
    start = setup.start
    if start.spacing <= setup.collision_distance:
        raise InputError(
            f"start.spacing = {start.spacing:g} m given, it must be beyond the collision distance, "
            f"{setup.collision_distance:g} m"
        )
    vehicle = scene.read_robot(fleet.conditions(setup)).vehicle
    # Robots that are turned at random must not start with their hulls in each other: one would be thrown on its back.
    diagonal = math.hypot(vehicle.length + 2.0 * vehicle.margin, vehicle.breadth + 2.0 * vehicle.margin)
    if any_bodies(setup.plants) and start.spacing <= diagonal:
        raise InputError(
            f"start.spacing = {start.spacing:g} m given; with the rigid plant it must be beyond the diagonal of a "
            f"robot's footprint, {diagonal:.3g} m"
        )
    farthest = start.distance + polygon_circumradius(start.spacing, setup.robots)
    if farthest >= setup.field.leader_range:
        raise InputError(
            f"field.leader_range = {setup.field.leader_range:g} m given; it must reach the start, up to {farthest:g} m "
            "from the leader, or nothing draws the robots there"
        )


def _check_vehicle(setup: Scenario) -> None:
    """Checks ground, gains and mass; see `check`."""
    if isinstance(setup.vehicle.friction, tuple) and setup.vehicle.friction[0] > setup.vehicle.friction[1]:
        low, high = setup.vehicle.friction
        raise InputError(f"vehicle.friction = {low:g}..{high:g} given, the first must not be above the second")
    if setup.vehicle.slope != 0.0 and not any_bodies(setup.plants):
        raise InputError(f"vehicle.slope = {setup.vehicle.slope:g} given with point masses alone, which know no ground")
    fleet.local_laws(setup)
    vehicle = scene.read_robot(fleet.conditions(setup)).vehicle
    # The same mass, so that the body is all that differs.
    if any_bodies(setup.plants) and abs(fleet.mass(setup) - vehicle.mass) > 1e-6:
        raise InputError(
            f"mass = {setup.mass:g} kg given; with the rigid plant it must be the model's and its payload, "
            f"{vehicle.mass:g} kg"
        )


def _check_sizes(tree: Mapping[str, Any], defaults: Mapping[str, Any], prefix: str = "") -> None:
    """Refuses quantities that are far too large, most in thousandths of the unit that is meant, or far too small.

    Raises:
        InputError: With the first of them.
    """
    for key, value in tree.items():
        name, default = f"{prefix}{key}", defaults[key]
        if isinstance(value, dict):
            _check_sizes(value, default, f"{name}.")
        elif isinstance(value, float) and value < math.inf:
            least, most = _sizes(name, default)
            if not least <= value <= most:
                unit = f" {UNITS[key]}" if key in UNITS else ", in SI units"
                bound, factor = (f"at most {most:g}", 1e-3) if value > most else (f"at least {least:g}", 1e3)
                raise InputError(f"{name} = {value:g} given, it must be {bound}{unit}; is {factor * value:g} meant?")


def _sizes(name: str, default: Any) -> tuple[float, float]:
    """Returns the smallest and the largest value that is no mistake of its unit; errors may be as small as you like."""
    usual = default if isinstance(default, float) and default > 0.0 else _USUAL.get(name.rpartition(".")[2], math.inf)
    least = usual / _FAR if name in _NEVER_TINY and usual < math.inf else -math.inf
    return least, _FAR * usual


def _check_perception(setup: Scenario) -> None:
    """Checks velocity sources, filters and sensors; see `check`."""
    if setup.velocity in ("odometry", "reference") and not all(KINDS[name].body for name in setup.plants):
        raise InputError(f"velocity = {setup.velocity!r} given with point masses; it exists on bodies only")
    errs = [name for name in setup.estimators if name != "perfect"]
    unfitted = [name for name in errs if not hasattr(setup.fitted, name)]
    if unfitted and "fitted" in setup.perception:
        raise InputError(f"perception = 'fitted' given with {unfitted[0]}, whose errors nobody has fitted")
    single = [name for name in errs if not estimators.has_twin(name)]
    if single and "filter" in setup.perception and setup.filter.implementation == "filterpy":
        raise InputError(f"filter.implementation = 'filterpy' given with {single[0]}, which is not on FilterPy")
    if setup.filter.implementation == "filterpy" and "filter" in setup.perception and setup.trials > 1:
        raise InputError(
            f"filter.implementation = 'filterpy' given with {setup.trials} trials; it filters one robot at a time and "
            "is for single trials: 'batched' gives the same"
        )
    steepness = abs(setup.vehicle.slope) + math.tan(setup.sensors.ground.slope)
    if any_bodies(setup.plants) and "filter" in setup.perception and steepness > _STEEPEST:
        raise InputError(
            f"vehicle.slope = {setup.vehicle.slope:g} and sensors.ground.slope = {setup.sensors.ground.slope:g} given "
            f"with the perception filter on rigid robots, allowed are together {_STEEPEST:g}: accelerometers feel a "
            "slope as acceleration, and on a steeper one odometry loses hold"
        )
    perception_options.check(setup.filter)
    sensing_options.check(setup.sensors, setup.robots)
