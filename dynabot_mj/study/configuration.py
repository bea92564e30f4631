"""Configurations from TOML and options, and back to TOML.

Precedence is defaults < TOML < command line. Whatever is wrong is told in one line.
"""

import json
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tomli_w
from pydantic import TypeAdapter, ValidationError

from dynabot_mj.common.exceptions import InputError, one_line
from dynabot_mj.common.validation import UNITS
from dynabot_mj.plants.options import VehicleOptions
from dynabot_mj.study import checks, methods
from dynabot_mj.study.methods import BUILT_IN
from dynabot_mj.study.scenario import Scenario

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

_NONE: Mapping[str, Any] = {}
_DIGITS = "a number has too many digits"  # Python reads and writes 4,300
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

    Example:
        >>> dy.parse_scenario("robots = 4", "my study", trials=20).trials
        20
    """
    return build({**defaults, **parsed(text, origin)}, origin, **options)


def load_file(
    path: Path | str, defaults: Mapping[str, Any] = _NONE, typed: Mapping[str, str] = _NONE, **options: Any
) -> Scenario:
    """Reads a configuration file.

    Args:
        path: Of a TOML file.
        defaults: See `load`.
        typed: See `build`.
        **options: See `load`.

    Raises:
        InputError: If it cannot be read or is not TOML, or a key or a value is not allowed.

    Example:
        >>> from pathlib import Path
        >>> size = Path("study.toml").write_text("trials = 20")
        >>> dy.load_scenario("study.toml", robots=4).robots
        4
    """
    return build({**defaults, **read(path)}, str(path), typed, **options)


def read(path: Path | str) -> dict[str, Any]:
    """Reads a TOML file as a tree of plain values.

    Raises:
        InputError: If it cannot be read or is not TOML.
    """
    try:
        text = Path(path).read_text(encoding="utf-8-sig")  # some editors put a byte order mark first
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not a text file"
        raise InputError(f"cannot read the configuration {path}: {reason}") from error
    return parsed(text, str(path))


def build(
    tree: Mapping[str, Any], origin: str = "options", typed: Mapping[str, str] = _NONE, **options: Any
) -> Scenario:
    """Builds a configuration from a tree of plain values and overriding options; see `load`.

    Args:
        tree: Of top-level keys.
        origin: Where it comes from, for the messages.
        typed: What the user typed to set a key with its tables, such as `--duration`.
        **options: See `load`.

    Raises:
        InputError: If a key or a value is not allowed, or two contradict each other.

    Example:
        >>> setup = dy.build_scenario({"robots": 4, "radio": {"message_bytes": 40}}, trials=20)
        >>> setup.robots, setup.radio.message_bytes, setup.trials
        (4, 40, 20)
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
    if "method" in merged:
        merged["method"] = methods.merged(merged["method"])
    try:
        # Strict validation refuses plain dicts for dataclasses; from JSON it accepts them and is as strict otherwise.
        setup = TypeAdapter(Scenario).validate_json(_json(merged, origin))
    except ValidationError as error:
        if (first := error.errors(include_url=False)[0])["type"] == "json_invalid":  # nested too deeply for it
            raise InputError(f"{origin} is no configuration: {first['ctx']['error']}") from error
        own = given if isinstance(given := merged.get("method"), Mapping) else {}
        tree = asdict(Scenario(method={**BUILT_IN, **dict.fromkeys(own, BUILT_IN["decoupled"])}))
        told = one_line(error, _keys(tree), typed, UNITS)
        raise InputError(told if told.startswith("--") else f"{origin}: {told}") from error
    try:
        checks.check(setup)
    except InputError as error:
        for key, option in typed.items():
            if (told := str(error)).startswith(f"{key} = "):
                raise type(error)(f"{option} {told.removeprefix(f'{key} = ')}") from error
        raise
    return setup


def dump(setup: Scenario) -> str:
    """Returns the whole configuration as TOML; `load` gives the same scenario back.

    Args:
        setup: The configuration.

    Example:
        >>> setup = dy.build_scenario({"robots": 4})
        >>> dy.parse_scenario(dy.dump_scenario(setup), "a copy") == setup
        True
    """
    return toml(setup)


def toml(options: "DataclassInstance") -> str:
    """Returns options as TOML, which has no word for nothing: what is None is left out."""
    return tomli_w.dumps(asdict(options, dict_factory=lambda pairs: {k: v for k, v in pairs if v is not None}))


def _keys(tree: Mapping[str, Any], prefix: str = "") -> Iterator[str]:
    """Yields the keys of a tree with those of their tables, as `radio.message_bytes`."""
    for key, value in tree.items():
        yield f"{prefix}{key}"
        if isinstance(value, dict):
            yield from _keys(value, f"{prefix}{key}.")


def parsed(text: str, origin: str) -> dict[str, Any]:
    """Returns TOML as a tree of plain values.

    Raises:
        InputError: If it is none.
    """
    try:
        tree = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{origin} is not TOML: {error}") from error
    except RecursionError:
        raise InputError(f"{origin} is no configuration: brackets are nested too deeply") from None
    except ValueError:
        raise InputError(f"{origin} is no configuration: {_DIGITS}") from None
    _json(tree, origin)  # what cannot be written could not even be told in a message
    return tree


def _json(tree: Mapping[str, Any], origin: str) -> str:
    """Returns a tree of plain values as JSON."""
    try:
        return json.dumps(tree, default=str)
    except RecursionError:
        raise InputError(f"{origin} is no configuration: tables are nested too deeply") from None
    except ValueError:
        raise InputError(f"{origin} is no configuration: {_DIGITS}") from None
