"""The columns of a log of one robot's sensors, and what is refused; `docs/logs.md` is about them.

One row per inertial sample. Fixes stand in the row of the sample that they had arrived before, with the time stamped on
them. What a row does not have is NaN. Columns carry their unit in their name:

    time_s                                                                     increasing
    acceleration_x_mps2, acceleration_y_mps2, yaw_rate_radps                   means since the row before
    bearing_rad                                                                now
    fix_time_s, fix_x_m, fix_y_m, fix_vx_mps, fix_vy_mps                       where one has arrived
    wheel_speed_front_left_radps ... motor_current_front_left_a ...            optional, four and four
    true_x_m, true_y_m, true_heading_rad                                       optional
"""

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.plants.scene import WHEELS

Place = Callable[[int], str]  # names a row to a reader, from its index
_Refuse = Callable[[BoolArray, str, Callable[[int], str]], None]  # where some rows of a column are bad, with the reason

_TURN = 2.0 * np.pi
_ROUNDING = 1e-9  # by which a fix's stamp may seem to be later than its row [s]


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """A field of `logs.Log` in a file."""

    columns: tuple[str, ...]
    unit: str
    meaning: str
    optional: bool = False


QUANTITIES = {
    "time": Quantity(columns=("time_s",), unit="s", meaning="time of the sample"),
    "specific_force_b": Quantity(
        columns=("acceleration_x_mps2", "acceleration_y_mps2"),
        unit="m s-2",
        meaning="mean specific force since the sample before, x ahead, y to the left",
    ),
    "yaw_rate": Quantity(
        columns=("yaw_rate_radps",), unit="rad s-1", meaning="mean since the sample before, counter-clockwise"
    ),
    "bearing": Quantity(columns=("bearing_rad",), unit="rad", meaning="from the world's x axis, counter-clockwise"),
    "fix_time": Quantity(columns=("fix_time_s",), unit="s", meaning="stamped on the fix that has arrived"),
    "fix_position_w": Quantity(columns=("fix_x_m", "fix_y_m"), unit="m", meaning="position of the fix"),
    "fix_velocity_w": Quantity(columns=("fix_vx_mps", "fix_vy_mps"), unit="m s-1", meaning="velocity of the fix"),
    "wheel_speed": Quantity(
        columns=tuple(f"wheel_speed_{wheel}_radps" for wheel in WHEELS),
        unit="rad s-1",
        meaning="positive ahead",
        optional=True,
    ),
    "motor_current": Quantity(
        columns=tuple(f"motor_current_{wheel}_a" for wheel in WHEELS),
        unit="A",
        meaning="positive when it drives ahead",
        optional=True,
    ),
    "position_w": Quantity(
        columns=("true_x_m", "true_y_m"), unit="m", meaning="true position of the centre", optional=True
    ),
    "heading": Quantity(columns=("true_heading_rad",), unit="rad", meaning="true heading", optional=True),
}
_FIX = tuple(name for field in ("fix_time", "fix_position_w", "fix_velocity_w") for name in QUANTITIES[field].columns)

COLUMNS = tuple(name for one in QUANTITIES.values() for name in one.columns)
REQUIRED = tuple(name for one in QUANTITIES.values() if not one.optional for name in one.columns)


def check_header(names: Sequence[str], path: Path) -> None:
    """Refuses columns that are missing, unknown or there twice.

    Args:
        names: Of the columns.
        path: Where they are, for the messages.

    Raises:
        InputError: With the first wrong one.
    """
    if len(names) == 1 and any(separator in names[0] for separator in ";\t"):
        raise InputError(f"{path}, line 1: cells must be separated by commas")
    missing = [name for name in REQUIRED if name not in names]
    if missing:
        raise InputError(f"{path}: required columns are missing: {', '.join(missing)}")
    for name in names:
        if name not in COLUMNS:
            raise InputError(f"{path}: unknown column {name!r}; known are {', '.join(COLUMNS)}")
        if names.count(name) > 1:
            raise InputError(f"{path}: column {name} is there {names.count(name)} times")
    for quantity in QUANTITIES.values():
        lacking = [name for name in quantity.columns if name not in names]
        if 0 < len(lacking) < len(quantity.columns):
            raise InputError(f"{path}: {', '.join(lacking)} missing; of {', '.join(quantity.columns)}, all or none")


def check(columns: Mapping[str, Array], path: Path, place: Place) -> None:
    """Refuses what no estimator could be run over, each time the first row with such a thing.

    Args:
        columns: By name, (N,) each.
        path: Where they are, for the messages.
        place: How its reader finds a row.

    Raises:
        InputError: With the row and the column.
    """
    refuse = functools.partial(_refuse, path, place)
    time, bearing = columns["time_s"], columns["bearing_rad"]
    if len(time) < 2:
        raise InputError(f"{path}: a log must have at least two rows of samples, this one has {len(time)}")
    for name, values in columns.items():
        refuse(np.isinf(values), name, lambda i: "an infinite value")
    refuse(np.isnan(time), "time_s", lambda i: "a row must have a time")
    late = np.diff(time, prepend=-np.inf) <= 0.0
    refuse(late, "time_s", lambda i: f"{time[i]} is not after the row before, {time[i - 1]}")
    refuse(
        np.abs(bearing) > _TURN,
        "bearing_rad",
        lambda i: f"{bearing[i]} is more than a turn, 2 pi rad; is it in degrees?",
    )
    fixed = _check_fixes(columns, path, refuse)
    if np.isnan(bearing[fixed]).all():
        raise InputError(f"{path}: no row has both a fix and a bearing; estimators start in such a row")


def _check_fixes(columns: Mapping[str, Array], path: Path, refuse: _Refuse) -> npt.NDArray[np.intp]:
    """Checks the columns of the fixes; returns the rows that have one."""
    time, fix_time = columns["time_s"], columns["fix_time_s"]
    given = np.stack([np.isfinite(columns[name]) for name in _FIX])
    for name in _FIX:
        partly = given.any(axis=0) & np.isnan(columns[name])
        refuse(partly, name, lambda i: "empty, but other cells of its fix are not")
    refuse(
        fix_time > time + _ROUNDING,
        "fix_time_s",
        lambda i: f"the fix is stamped {fix_time[i]}, after the time of its row, {time[i]}",
    )
    fixed = np.flatnonzero(given[0])
    if not fixed.size:
        raise InputError(f"{path}: there is no fix in columns {', '.join(_FIX)}; without one nothing can be estimated")
    again = np.zeros(len(time), dtype=bool)
    again[fixed[1:]] = np.diff(fix_time[fixed]) <= 0.0
    refuse(
        again,
        "fix_time_s",
        lambda i: f"{fix_time[i]} is not after the fix before; each fix belongs in one row, where it arrived",
    )
    return fixed


def _refuse(path: Path, place: Place, bad: BoolArray, column: str, reason: Callable[[int], str]) -> None:
    if bad.any():
        index = int(bad.argmax())
        raise InputError(f"{path}, {place(index)}, column {column}: {reason(index)}")
