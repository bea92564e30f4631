import re
import tempfile
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.sensing.logs import files
from dynabot_mj.sensing.logs.columns import COLUMNS, REQUIRED

HEADER = ",".join(REQUIRED)
# Lines 2 to 5 of a file; fixes in lines 3 and 5.
LINES = (
    "0.0,0.1,0.2,0.3,0.4,,,,,",
    "0.5,0.1,0.2,0.3,0.4,0.25,1,2,3,4",
    "1.0,0.1,0.2,0.3,0.4,,,,,",
    "1.5,0.1,0.2,0.3,0.4,1.25,1,2,3,4",
)


@pytest.fixture
def columns(tmp_path):
    """What a file of `LINES` with all the optional columns holds."""
    optional = ",1.5" * (len(COLUMNS) - len(REQUIRED))
    (tmp_path / "columns.csv").write_text(text(*(line + optional for line in LINES), header=",".join(COLUMNS)))
    return files.read(tmp_path / "columns.csv")


def refused(tmp_path, text, name="log.csv"):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InputError) as caught:
        files.read(path)
    message = str(caught.value)
    assert "\n" not in message
    assert str(path) in message
    return message.replace(str(path), "LOG")


def text(*lines, header=HEADER):
    return "\n".join([header, *lines]) + "\n"


def edited(line, column, cell):
    """Returns a log with one cell changed, by its line in the file and the column's name."""
    lines = [one.split(",") for one in LINES]
    lines[line - 2][REQUIRED.index(column)] = cell
    return text(*(",".join(one) for one in lines))


def test_netcdf_states_units_over_samples(columns, tmp_path):
    files.write(tmp_path / "log.nc", columns)
    with xr.open_dataset(tmp_path / "log.nc", engine="h5netcdf", decode_times=False) as dataset:
        assert list(dataset.variables) == list(COLUMNS)
        assert dict(dataset.sizes) == {"sample": 4}
        assert dataset.motor_current_rear_left_a.attrs["units"] == "A"
        assert all(variable.attrs["units"] and variable.attrs["long_name"] for variable in dataset.variables.values())


def test_columns_are_free_in_order_and_cells_may_be_missing(tmp_path):
    columns = [*reversed(REQUIRED), "true_heading_rad"]
    rows = [[*reversed(line.split(",")), "nan"] for line in LINES]
    rows[2][columns.index("yaw_rate_radps")] = " NaN "
    rows[2][columns.index("bearing_rad")] = ""
    content = "\r\n".join(",".join(cells) for cells in [columns, *rows[:2], [], *rows[2:]])
    (tmp_path / "log.csv").write_bytes(b"\xef\xbb\xbf" + content.encode())
    found = files.read(tmp_path / "log.csv")
    assert list(found) == columns
    np.testing.assert_array_equal(found["time_s"], [0.0, 0.5, 1.0, 1.5])
    np.testing.assert_array_equal(found["acceleration_y_mps2"], [0.2] * 4)
    np.testing.assert_array_equal(found["yaw_rate_radps"], [0.3, 0.3, np.nan, 0.3])
    np.testing.assert_array_equal(found["bearing_rad"], [0.4, 0.4, np.nan, 0.4])
    np.testing.assert_array_equal(found["fix_time_s"], [np.nan, 0.25, np.nan, 1.25])
    assert np.isnan(found["true_heading_rad"]).all()


@pytest.mark.parametrize(
    ("line", "column", "cell", "reason"),
    [
        (4, "yaw_rate_radps", "fast", "'fast' is not a number"),
        (4, "yaw_rate_radps", "1_0", "'1_0' is not a number"),
        (4, "time_s", "", "a row must have a time"),
        (4, "time_s", "nan", "a row must have a time"),
        (5, "fix_time_s", "0.25", "0.25 is not after the fix before; each fix belongs in one row, where it arrived"),
    ],
)
def test_a_wrong_cell_is_named_by_line_and_column(tmp_path, line, column, cell, reason):
    assert refused(tmp_path, edited(line, column, cell)) == f"LOG, line {line}, column {column}: {reason}"


def test_lines_are_those_of_an_editor(tmp_path):
    wrong = edited(4, "yaw_rate_radps", "fast").replace("\n0.5", "\n\n\n0.5")
    assert refused(tmp_path, wrong).startswith("LOG, line 6, column yaw_rate_radps:")
    late = edited(4, "time_s", "0.1").replace("\n0.1,", "\n\n0.1,")
    assert refused(tmp_path, late).startswith("LOG, line 5, column time_s:")


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("", "LOG: the file is empty"),
        ("\n\n", "LOG: the file is empty"),
        (b"\x89PNG\r\n\x1a\n", "LOG: not a text file in UTF-8"),
        (b"a\0b", "LOG: not a text file in UTF-8"),
        (text(), "LOG: a log must have at least two rows of samples, this one has 0"),
        (text(*LINES).replace(",", ";"), "LOG, line 1: cells must be separated by commas"),
        (text("0,0,0", header="time_s,fix_x_m,fix_y_m"), "LOG: required columns are missing: acceleration_x_mps2, "),
        (text(*LINES[:2], "1.0,0.1"), "LOG, line 4: 2 cells, but the header has 10 columns"),
        (text(LINES[0], LINES[1] + ",5"), "LOG, line 3: 11 cells, but the header has 10 columns"),
        (text(LINES[0], '"1.0'), "LOG, line 3: "),
    ],
)
def test_a_wrong_file_is_refused(tmp_path, content, reason):
    assert refused(tmp_path, content).startswith(reason)


def test_a_wrong_place_is_refused(tmp_path, columns):
    with pytest.raises(InputError, match=r"unknown extension '\.xlsx' of a log, allowed are \.csv and \.nc"):
        files.read(tmp_path / "log.xlsx")
    with pytest.raises(InputError, match="unknown extension ''"):
        files.write(tmp_path / "log", columns)
    for name in ("log.csv", "log.nc"):
        with pytest.raises(InputError, match=f"cannot read the log .*{name}: No such file"):
            files.read(tmp_path / name)
        (tmp_path / name).mkdir()
        with pytest.raises(InputError, match="cannot read the log"):
            files.read(tmp_path / name)
        with pytest.raises(InputError, match="a folder is in the place of the log"):
            files.require_writable(tmp_path / name)
    files.require_writable(tmp_path / "new" / "log.csv")
    assert (tmp_path / "new").is_dir()
    with pytest.raises(InputError, match="unknown extension"):
        files.require_writable(tmp_path / "log.txt")


def test_a_wrong_netcdf_file_is_refused(tmp_path, columns):
    files.write(tmp_path / "right.nc", columns)
    with xr.open_dataset(tmp_path / "right.nc", engine="h5netcdf", decode_times=False) as dataset:
        right = dataset.load()

    def refusal(dataset):
        return refused(tmp_path, bytes(dataset.to_netcdf(engine="h5netcdf")), "wrong.nc")

    assert refused(tmp_path, text(*LINES), "text.nc") == "LOG: not a NetCDF-4 file"
    whole = (tmp_path / "right.nc").read_bytes()
    assert refused(tmp_path, whole[: len(whole) // 2], "half.nc") == "LOG: not a NetCDF-4 file"
    assert refusal(right.drop_vars("bearing_rad")) == "LOG: required columns are missing: bearing_rad"
    assert refusal(right.assign(battery_v=("sample", columns["time_s"]))).startswith("LOG: unknown column 'battery_v'")
    assert (
        refusal(right.assign(bearing_rad=("time", columns["bearing_rad"])))
        == "LOG, column bearing_rad: float64 over (time) given, it must be numbers over (sample)"
    )
    message = refusal(right.assign(time_s=("sample", [0.0, 0.5, 0.25, 1.5])))
    assert message == "LOG, sample 2, column time_s: 0.25 is not after the row before, 0.5"


@given(line=st.integers(2, 5), column=st.sampled_from(REQUIRED), cell=st.text("0123456789.-e xnaif", max_size=6))
def test_any_cell_is_read_or_named(line, column, cell):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.csv"
        path.write_text(edited(line, column, cell))
        message = None
        try:
            files.read(path)
        except InputError as error:
            message = str(error)
        # The row after a late one, and the other cells of a fix, may be where it shows.
        assert message is None or re.fullmatch(rf"{re.escape(str(path))}, line [2-5], column \w+: .+", message)
