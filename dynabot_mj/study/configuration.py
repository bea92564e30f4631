"""Configurations from TOML and options, and back to TOML.

Precedence is defaults < TOML < command line. Whatever is wrong is told in one line.
"""

import json
import math
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tomli_w
from pydantic import TypeAdapter, ValidationError

from dynabot_mj.common.exceptions import InputError, one_line
from dynabot_mj.common.validation import UNITS
from dynabot_mj.controllers.potential_field import polygon_circumradius
from dynabot_mj.formation import laws as control_laws
from dynabot_mj.perception import filter_parameters
from dynabot_mj.plants import scene
from dynabot_mj.plants.options import VehicleOptions
from dynabot_mj.sensing import errors
from dynabot_mj.study.methods import Methods
from dynabot_mj.study.scenario import (
    Scenario,
    conditions,
    duration,
    field,
    laws,
    mass,
    method,
    periods,
)

# Rise per metre up to which rigid robots with real accelerometers keep to their forces; they ran away from 0.053 on.
_STEEPEST = 0.04
if TYPE_CHECKING:
    from _typeshed import DataclassInstance

# A value is refused beyond so many times its default, and some below that part of it: a factor of 1,000 in its unit is.
_FAR = 300.0
# In place of defaults that follow from others, or are zero [s], [m], [kg].
_USUAL = {"sample_period": 2.0 / _FAR, "control_period": 2.0 / _FAR, "neighbour_range": 10.0, "mass": 12.0}
_USUAL["payload"] = 100.0 / _FAR
_NEVER_TINY = ("mass", "field.spacing", "field.neighbour_range", "start.distance")
_NONE: Mapping[str, Any] = {}
# Tables of the options that are not top-level keys.
TABLES = {"utilisation": "processor", "headings": "start", "implementation": "filter"} | {
    field.name: "vehicle" for field in fields(VehicleOptions)
}


def load(text: str, origin: str, defaults: Mapping[str, Any] = _NONE, **options: Any) -> Scenario:
    """Reads a configuration.

    Args:
        text: TOML.
        origin: Where it comes from, for the messages.
        defaults: Top-level keys that stand where the text has none, in place of the configuration's own defaults.
        **options: Top-level keys that override the text's, and `utilisation`, `headings`, `implementation` and the keys
            of `vehicle` of their tables; None where not given.

    Raises:
        InputError: If the text is not TOML, or a key or a value is not allowed.
    """
    return build({**defaults, **_parsed(text, origin)}, origin, **options)


def load_file(
    path: Path, defaults: Mapping[str, Any] = _NONE, typed: Mapping[str, str] = _NONE, **options: Any
) -> Scenario:
    """Reads a configuration file; see `load` and `build`."""
    return build({**defaults, **read(path)}, str(path), typed, **options)


def read(path: Path) -> dict[str, Any]:
    """Reads a TOML file as a tree of plain values.

    Raises:
        InputError: If it cannot be read or is not TOML.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")  # some editors put a byte order mark first
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not a text file"
        raise InputError(f"cannot read the configuration {path}: {reason}") from error
    return _parsed(text, str(path))


def build(
    tree: Mapping[str, Any], origin: str = "options", typed: Mapping[str, str] = _NONE, **options: Any
) -> Scenario:
    """Builds a configuration from a tree of plain values and overriding options; see `load`.

    Args:
        tree: Of top-level keys.
        origin: Where it comes from, for the messages.
        typed: What the user typed to set a key with its tables, such as `--duration`.
        **options: See `load`.
    """
    merged = dict(tree)
    for key, value in options.items():
        table = TABLES.get(key)
        if value is None:
            continue
        if table is None:
            merged[key] = value
        elif isinstance(merged.get(table, {}), dict):
            merged[table] = {**merged.get(table, {}), key: value}
    for name, rows in asdict(Methods()).items():
        given = merged.get("method", {})
        if isinstance(given, dict) and isinstance(given.get(name), dict):
            # A row that sets one gain keeps the others.
            merged["method"] = {**given, name: {**rows, **given[name]}}
    try:
        # Strict validation refuses plain dicts for dataclasses; from JSON it accepts them and is as strict otherwise.
        setup = TypeAdapter(Scenario).validate_json(json.dumps(merged, default=str))
    except ValidationError as error:
        told = one_line(error, _keys(asdict(Scenario())), typed, UNITS)
        raise InputError(told if told.startswith("--") else f"{origin}: {told}") from error
    try:
        check(setup)
    except InputError as error:
        for key, option in typed.items():
            if (told := str(error)).startswith(f"{key} = "):
                raise type(error)(f"{option} {told.removeprefix(f'{key} = ')}") from error
        raise
    return setup


def dump(setup: Scenario) -> str:
    """Returns the whole configuration as TOML; `load` gives the same scenario back."""
    return toml(setup)


def toml(options: "DataclassInstance") -> str:
    """Returns options as TOML, which has no word for nothing: what is None is left out."""
    return tomli_w.dumps(asdict(options, dict_factory=lambda pairs: {k: v for k, v in pairs if v is not None}))


def check(setup: Scenario) -> None:
    """Checks what no single value shows.

    Raises:
        InputError: With the values that do not fit together.
    """
    _check_sizes(asdict(setup), asdict(Scenario()))
    for estimator in setup.estimators:
        _, control_ticks = periods(setup, estimator)
        control_period = control_ticks * setup.processor.tick
        if duration(setup) < control_period:
            raise InputError(
                f"duration = {duration(setup):g} s given, it must be at least the control period of {estimator}, "
                f"{control_period:g} s"
            )
        uncertainty = method(setup, estimator).uncertainty
        if (uncertainty == 0.0) != (estimator == "perfect"):
            raise InputError(
                f"method.{estimator}.uncertainty = {uncertainty:g} m given; "
                "it is 0 for perfect and positive for all others"
            )
        wells = field(setup, estimator)
        for name, well in (("leader_range", wells.leader), ("neighbour_range", wells.neighbour)):
            if well.range <= well.radius + well.width:
                raise InputError(
                    f"field.{name} = {well.range:g} m given, it must be beyond the well's floor, which ends at "
                    f"{well.radius + well.width:g} m"
                )
    start = setup.start
    if start.spacing <= setup.collision_distance:
        raise InputError(
            f"start.spacing = {start.spacing:g} m given, it must be beyond the collision distance, "
            f"{setup.collision_distance:g} m"
        )
    vehicle = scene.read_robot(conditions(setup)).vehicle
    # Robots that are turned at random must not start with their hulls in each other: one would be thrown on its back.
    diagonal = math.hypot(vehicle.length + 2.0 * vehicle.margin, vehicle.breadth + 2.0 * vehicle.margin)
    if "rigid" in setup.plants and start.spacing <= diagonal:
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
    _check_perception(setup)
    control_laws.source(setup.controller)
    if isinstance(setup.vehicle.friction, tuple) and setup.vehicle.friction[0] > setup.vehicle.friction[1]:
        low, high = setup.vehicle.friction
        raise InputError(f"vehicle.friction = {low:g}..{high:g} given, the first must not be above the second")
    if setup.vehicle.slope != 0.0 and "rigid" not in setup.plants:
        raise InputError(
            f"vehicle.slope = {setup.vehicle.slope:g} given with the plant particle alone, which knows no ground"
        )
    laws(setup)
    # The same mass, so that the body is all that differs.
    if "rigid" in setup.plants and abs(mass(setup) - vehicle.mass) > 1e-6:
        raise InputError(
            f"mass = {setup.mass:g} kg given; with the rigid plant it must be the model's and its payload, "
            f"{vehicle.mass:g} kg"
        )


def _keys(tree: Mapping[str, Any], prefix: str = "") -> Iterator[str]:
    """Yields the keys of a tree with those of their tables, as `radio.message_bytes`."""
    for key, value in tree.items():
        yield f"{prefix}{key}"
        if isinstance(value, dict):
            yield from _keys(value, f"{prefix}{key}.")


def _parsed(text: str, origin: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{origin} is not TOML: {error}") from error
    except RecursionError:
        raise InputError(f"{origin} is no configuration: brackets are nested too deeply") from None


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
    if setup.velocity in ("odometry", "reference") and "particle" in setup.plants:
        raise InputError(f"velocity = {setup.velocity!r} given with the plant particle; it exists on rigid robots only")
    if setup.filter.implementation == "filterpy" and "filter" in setup.perception and setup.trials > 1:
        raise InputError(
            f"filter.implementation = 'filterpy' given with {setup.trials} trials; it filters one robot at a time and "
            "is for single trials: 'batched' gives the same"
        )
    steepness = abs(setup.vehicle.slope) + math.tan(setup.sensors.ground.slope)
    if "rigid" in setup.plants and "filter" in setup.perception and steepness > _STEEPEST:
        raise InputError(
            f"vehicle.slope = {setup.vehicle.slope:g} and sensors.ground.slope = {setup.sensors.ground.slope:g} given "
            f"with the perception filter on rigid robots, allowed are together {_STEEPEST:g}: accelerometers feel a "
            "slope as acceleration, and on a steeper one odometry loses hold"
        )
    filter_parameters.check(setup.filter)
    errors.check(setup.sensors, setup.robots)
