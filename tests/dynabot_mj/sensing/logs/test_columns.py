import re
from pathlib import Path

import numpy as np
import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.plants.scene import WHEELS
from dynabot_mj.sensing.logs import columns as log_columns
from dynabot_mj.sensing.logs.columns import REQUIRED

PATH, NAN = Path("log.csv"), np.nan
CURRENTS = tuple(f"motor_current_{wheel}_a" for wheel in WHEELS)


def columns(**changes):
    """Four rows, fixes in the second and the last one."""
    found = {name: np.full(4, 0.1) for name in REQUIRED}
    found["time_s"] = np.array([0.0, 0.5, 1.0, 1.5])
    found["fix_time_s"] = np.array([NAN, 0.25, NAN, 1.25])
    for index, name in enumerate(("fix_x_m", "fix_y_m", "fix_vx_mps", "fix_vy_mps")):
        found[name] = np.array([NAN, index, NAN, index])
    return {**found, **{name: np.array(values, dtype=float) for name, values in changes.items()}}


def check(given):
    log_columns.check(given, PATH, "row {}".format)


def test_missing_samples_are_allowed():
    missing = [0.1, 0.1, NAN, 0.1]
    check(columns(bearing_rad=missing, yaw_rate_radps=missing, true_heading_rad=[NAN] * 4))


@pytest.mark.parametrize(
    ("column", "values", "message"),
    [
        ("acceleration_x_mps2", [0, 0, -np.inf, 0], "row 2, column acceleration_x_mps2: an infinite value"),
        ("time_s", [0, 0.5, NAN, 1.5], "row 2, column time_s: a row must have a time"),
        ("time_s", [0, 0.5, 0.5, 1.5], "row 2, column time_s: 0.5 is not after the row before, 0.5"),
        (
            "bearing_rad",
            [0, 0, 0, 87.5],
            "row 3, column bearing_rad: 87.5 is more than a turn, 2 pi rad; is it in degr",
        ),
        ("fix_vx_mps", [NAN, NAN, NAN, 0], "row 1, column fix_vx_mps: empty, but other cells of its fix are not"),
        ("fix_time_s", [NAN, NAN, NAN, 1.25], "row 1, column fix_time_s: empty, but other cells of its fix are not"),
        (
            "fix_time_s",
            [NAN, 0.25, NAN, 1.75],
            "row 3, column fix_time_s: the fix is stamped 1.75, after the time of its row, 1.5",
        ),
        (
            "fix_time_s",
            [NAN, 0.25, NAN, 0.25],
            "row 3, column fix_time_s: 0.25 is not after the fix before; each fix belongs in one row, where it arrived",
        ),
    ],
)
def test_the_first_wrong_row_is_named(column, values, message):
    with pytest.raises(InputError, match=re.escape(f"log.csv, {message}")):
        check(columns(**{column: values}))


def test_a_log_without_anything_to_estimate_from_is_refused():
    with pytest.raises(InputError, match="a log must have at least two rows of samples, this one has 1"):
        check({name: values[:1] for name, values in columns().items()})
    silent = {name: np.full(4, NAN) for name in REQUIRED if name.startswith("fix")}
    with pytest.raises(InputError, match=f"there is no fix in columns {', '.join(REQUIRED[5:])}; without one"):
        check({**columns(), **silent})
    with pytest.raises(InputError, match="no row has both a fix and a bearing; estimators start in such a row"):
        check(columns(bearing_rad=[0.1, NAN, 0.1, NAN]))


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["time_s;yaw_rate_radps"], "log.csv, line 1: cells must be separated by commas"),
        ([name for name in REQUIRED if name != "bearing_rad"], "log.csv: required columns are missing: bearing_rad"),
        (["time_s", "fix_x_m"], "log.csv: required columns are missing: acceleration_x_mps2, "),
        (
            [*REQUIRED, "battery_v"],
            f"log.csv: unknown column 'battery_v'; known are {', '.join(log_columns.COLUMNS)}",
        ),
        ([*REQUIRED, "time_s"], "log.csv: column time_s is there 2 times"),
        ([*REQUIRED, "true_x_m"], "log.csv: true_y_m missing; of true_x_m, true_y_m, all or none"),
        ([*REQUIRED, *CURRENTS[:3]], f"log.csv: {CURRENTS[3]} missing; of {CURRENTS[0]},"),
    ],
)
def test_a_wrong_header_is_refused(names, message):
    with pytest.raises(InputError, match=f"^{re.escape(message)}"):
        log_columns.check_header(names, PATH)


def test_columns_are_free_in_order():
    log_columns.check_header([*CURRENTS, *reversed(REQUIRED)], PATH)
