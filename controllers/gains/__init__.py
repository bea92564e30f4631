"""Gain sets of the local laws: TOML files with their provenance.

The sets of this folder go by their names, others by their paths. A file has the tables `hand_point`, `heading` and
`traction`, each with all gains of its dataclass, and `provenance`: how the gains were found.
"""

import os
import sys
import tomllib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, TypeVar

import tomli_w

from dynabot_mj.controllers.steering import HandPoint, Heading
from dynabot_mj.controllers.traction import Traction

_FOLDER = Path(__file__).resolve().parent
_MAY_BE_ZERO = {"catch_up", "forget", "farthest", "preview", "deadband", "speed_gain", "yaw_gain", "scrub_torque"}
_Table = TypeVar("_Table", HandPoint, Heading, Traction)


@dataclass(frozen=True, kw_only=True)
class Gains:
    """One gain set, for either steering law."""

    hand_point: HandPoint
    heading: Heading
    traction: Traction


def names() -> list[str]:
    """Returns the names of the sets that come with the package."""
    return sorted(file.stem for file in _FOLDER.glob("*.toml"))


def path(name: str) -> Path:
    """Returns the file of a set.

    Args:
        name: Of a set of this package, or the path of a file.

    Raises:
        FileNotFoundError: If there is neither; the message lists the names.
    """
    for file in (_FOLDER / f"{name}.toml", Path(name)):
        if os.path.isfile(file):  # of a path that cannot be one too, which `Path.is_file` raises an error for
            return file
    raise FileNotFoundError(f"gains {name!r} given, it must be a gain file or one of: {', '.join(names())}")


def load(name: str) -> Gains:
    """Reads a gain set.

    Args:
        name: Of a set of this package, or the path of a file.

    Raises:
        FileNotFoundError: If there is none.
        ValueError: If the file is not a gain set; the message says where.
    """
    file = path(name)
    try:
        tree = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:  # also of a number with thousands of digits
        raise ValueError(f"the gain file {file} cannot be read: {error}") from error
    except RecursionError:
        raise ValueError(f"the gain file {file} cannot be read: brackets are nested too deeply") from None
    return Gains(
        hand_point=_table(tree, "hand_point", HandPoint, file),
        heading=_table(tree, "heading", Heading, file),
        traction=_table(tree, "traction", Traction, file),
    )


def dump(gains: Gains, provenance: Mapping[str, Any]) -> str:
    """Returns a gain set as TOML.

    Args:
        gains: The set.
        provenance: How it was found: plain values.
    """
    return tomli_w.dumps({**asdict(gains), "provenance": dict(provenance)})


def _table(tree: Mapping[str, Any], name: str, kind: type[_Table], file: Path) -> _Table:
    """Builds one table's dataclass, whole and with numbers that the law can work with."""
    table, needed = tree.get(name), [field.name for field in fields(kind)]
    if not isinstance(table, dict) or set(table) != set(needed):
        raise ValueError(f"the gain file {file} must have a table {name} with just these keys: {', '.join(needed)}")
    for key, value in table.items():
        number = isinstance(value, int | float) and not isinstance(value, bool)
        # The largest is Python's: whole numbers may be too large for a float.
        bounded = number and 0.0 <= value <= sys.float_info.max
        if not bounded or (value == 0.0 and key not in _MAY_BE_ZERO):
            allowed = "at least 0" if key in _MAY_BE_ZERO else "positive"
            raise ValueError(
                f"the gain file {file}: {name}.{key} = {_told(value)} given, it must be a finite number and {allowed}"
            )
    return kind(**{key: float(value) for key, value in table.items()})


def _told(value: Any) -> str:
    try:
        return str(value)
    except ValueError:  # Python writes no whole number of more than 4,300 digits
        return "a number with too many digits"
