"""Configurations from TOML and options, and back to TOML.

Precedence is defaults < TOML < command line. Whatever is wrong is told in one line.
"""

import json
import tomllib
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import tomli_w
from pydantic import TypeAdapter, ValidationError

from controllers.potential_field import polygon_circumradius
from dynabot_mj import scene
from dynabot_mj.errors import InputError
from dynabot_mj.scenario import Methods, Scenario, field, method, periods

_NONE: Mapping[str, Any] = {}


def load(text: str, origin: str, defaults: Mapping[str, Any] = _NONE, **options: Any) -> Scenario:
    """Reads a configuration.

    Args:
        text: TOML.
        origin: Where it comes from, for the messages.
        defaults: Top-level keys that stand where the text has none, in place of the configuration's own defaults.
        **options: Top-level keys that override the text's, and `utilisation` and `headings` of their tables; None where
            not given.

    Raises:
        InputError: If the text is not TOML, or a key or a value is not allowed.
    """
    try:
        tree = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{origin} is not TOML: {error}") from error
    return build({**defaults, **tree}, origin, **options)


def load_file(path: Path, defaults: Mapping[str, Any] = _NONE, **options: Any) -> Scenario:
    """Reads a configuration file; see `load`."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not a text file"
        raise InputError(f"cannot read the configuration {path}: {reason}") from error
    return load(text, str(path), defaults, **options)


def build(tree: Mapping[str, Any], origin: str = "options", **options: Any) -> Scenario:
    """Builds a configuration from a tree of plain values and overriding options; see `load`."""
    merged = dict(tree)
    for key, value in options.items():
        table = {"utilisation": "processor", "headings": "start"}.get(key)
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
        raise InputError(f"{origin}: {_one_line(error)}") from error
    check(setup)
    return setup


def dump(setup: Scenario) -> str:
    """Returns the whole configuration as TOML; `load` gives the same scenario back."""
    return tomli_w.dumps(asdict(setup))


def check(setup: Scenario) -> None:
    """Checks what no single value shows.

    Raises:
        InputError: With the values that do not fit together.
    """
    for estimator in setup.estimators:
        _, control_ticks = periods(setup, estimator)
        control_period = control_ticks * setup.processor.tick
        if setup.duration < control_period:
            raise InputError(
                f"duration = {setup.duration:g} s given, it must be at least the control period of {estimator}, "
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
    farthest = start.distance + polygon_circumradius(start.spacing, setup.robots)
    if farthest >= setup.field.leader_range:
        raise InputError(
            f"field.leader_range = {setup.field.leader_range:g} m given; it must reach the start, up to {farthest:g} m "
            "from the leader, or nothing draws the robots there"
        )
    if "rigid" in setup.plants:
        rigid_mass = scene.read_robot().vehicle.mass
        # The same mass, so that the body is all that differs.
        if abs(setup.mass - rigid_mass) > 1e-6:
            raise InputError(
                f"mass = {setup.mass:g} kg given; with the rigid plant it must be the model's, {rigid_mass:g} kg"
            )


def _one_line(error: ValidationError) -> str:
    """Returns pydantic's findings as `key = value: what is allowed`, joined."""
    lines: dict[str, str] = {}
    for found in error.errors(include_url=False):
        # Behind the field's own name, a union names its branch (such as "constrained-float") and a tuple its index.
        key = ".".join(part for part in found["loc"] if isinstance(part, str) and part.isidentifier())
        if found["type"] in ("extra_forbidden", "unexpected_keyword_argument"):
            lines[key] = f"unknown key {key}"
        else:
            # What a union or a tuple adds behind its first finding is about our types, not about the input.
            lines.setdefault(key, f"{key} = {found['input']!r}: {found['msg'][0].lower()}{found['msg'][1:]}")
    return "; ".join(lines.values())
