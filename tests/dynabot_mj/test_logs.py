import dataclasses
import re
import tempfile
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from dynabot_mj import logs, replay
from dynabot_mj.errors import InputError
from dynabot_mj.experiments import kinematic
from dynabot_mj.scene import WHEELS
from dynabot_mj.sensor_faults import Fault
from dynabot_mj.sensors import SensorOptions
from estimation import build

FIELDS = [field.name for field in dataclasses.fields(logs.Log)]
DOCUMENT = Path(__file__).parents[2] / "docs" / "logs.md"

HEADER = ",".join(logs.REQUIRED)
# Lines 2 to 5 of a file; fixes in lines 3 and 5.
LINES = (
    "0.0,0.1,0.2,0.3,0.4,,,,,",
    "0.5,0.1,0.2,0.3,0.4,0.25,1,2,3,4",
    "1.0,0.1,0.2,0.3,0.4,,,,,",
    "1.5,0.1,0.2,0.3,0.4,1.25,1,2,3,4",
)


@pytest.fixture(scope="module")
def drive():
    """Two runs of a circle with wheels, and samples with every kind of gap."""
    truth = kinematic.follow("circle", 2, 3, 8.0, 0.012)
    phase = truth.time[:, None, None] + np.arange(4) + np.arange(2)[:, None]
    truth = dataclasses.replace(truth, wheel_speed=30.0 * np.sin(phase), motor_current=5.0 * np.cos(phase))
    faults = (
        Fault(kind="nan", channel="gyro", start=1.0, end=1.5),
        Fault(kind="nan", channel="gps_velocity", start=2.0, end=2.5),
        Fault(kind="outage", start=4.0, end=5.0),
    )
    return truth, replay.record(truth, SensorOptions(faults=faults), 0.036, 3)


@pytest.fixture(scope="module")
def log(drive):
    truth, samples = drive
    return logs.from_run(samples, truth, 1)


def equal(one, other):
    for name in FIELDS:
        a, b = getattr(one, name), getattr(other, name)
        assert (a is None) == (b is None), name
        if a is not None:
            np.testing.assert_array_equal(a, b, strict=True, err_msg=name)


def refused(tmp_path, text, name="log.csv"):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InputError) as caught:
        logs.read(path)
    message = str(caught.value)
    assert "\n" not in message
    assert str(path) in message
    return message.replace(str(path), "LOG")


def text(*lines, header=HEADER):
    return "\n".join([header, *lines]) + "\n"


def edited(line, column, cell):
    """Returns a log with one cell changed, by its line in the file and the column's name."""
    lines = [one.split(",") for one in LINES]
    lines[line - 2][logs.REQUIRED.index(column)] = cell
    return text(*(",".join(one) for one in lines))


@pytest.mark.parametrize("extension", ["csv", "nc"])
def test_what_is_written_is_read_to_the_last_bit(log, tmp_path, extension):
    first, second = (tmp_path / f"{name}.{extension}" for name in "ab")
    logs.write(first, log)
    found = logs.read(first)
    equal(found, log)
    logs.write(second, found)
    assert first.read_bytes() == second.read_bytes()
    bare = dataclasses.replace(log, wheel_speed=None, motor_current=None, position_w=None, heading=None)
    logs.write(first, bare)
    equal(logs.read(first), bare)


@pytest.mark.parametrize("extension", ["csv", "nc"])
def test_a_file_gives_the_estimates_of_the_samples_in_memory(drive, log, tmp_path, extension):
    _, recorded = drive
    path = tmp_path / f"log.{extension}"
    logs.write(path, log)
    for name in build.NAMES:
        tracks = [replay.follow(one, build.build(name, (1,))) for one in (logs.read(path).samples, log.samples)]
        for field in dataclasses.fields(replay.Track):
            a, b = (getattr(track, field.name) for track in tracks)
            np.testing.assert_array_equal(a, b)
        # Of the run itself they differ by the rounding of time - age.
        run = replay.follow(recorded, build.build(name, (2,)))
        np.testing.assert_allclose(tracks[0].position_w[:, 0], run.position_w[:, 1], atol=1e-9)
        np.testing.assert_array_equal(tracks[0].known[:, 0], run.known[:, 1])


def test_a_log_of_a_run_has_its_samples_and_its_truth(drive, log):
    truth, recorded = drive
    samples = log.samples
    np.testing.assert_array_equal(samples.imu.period[:, 0], recorded.imu.period[:, 1])
    np.testing.assert_array_equal(samples.imu.bearing[:, 0], recorded.imu.bearing[:, 1])
    # A fix with a velocity that is not a number is none.
    usable = recorded.fix.received[:, 1] & np.isfinite(recorded.fix.velocity_w[:, 1]).all(axis=-1)
    assert usable.sum() < recorded.fix.received[:, 1].sum()
    np.testing.assert_array_equal(samples.fix.received[:, 0], usable)
    np.testing.assert_allclose(samples.fix.age[usable, 0], recorded.fix.age[usable, 1], atol=1e-12)
    np.testing.assert_array_equal(log.position_w, truth.position_w[::3, 1])
    np.testing.assert_array_equal(log.heading, truth.heading[::3, 1])
    assert np.abs(log.wheel_speed - truth.wheel_speed[::3, 1]).max() == pytest.approx(0.05, abs=0.01)
    assert np.abs(log.motor_current - truth.motor_current[::3, 1]).max() == pytest.approx(0.025, abs=0.005)


def test_netcdf_states_units_over_samples(log, tmp_path):
    logs.write(tmp_path / "log.nc", log)
    with xr.open_dataset(tmp_path / "log.nc", engine="h5netcdf", decode_times=False) as dataset:
        assert list(dataset.variables) == list(logs.COLUMNS)
        assert dict(dataset.sizes) == {"sample": len(log.time)}
        assert dataset.motor_current_rear_left_a.attrs["units"] == "A"
        assert all(variable.attrs["units"] and variable.attrs["long_name"] for variable in dataset.variables.values())


def test_columns_are_free_in_order_and_cells_may_be_missing(tmp_path):
    columns = [*reversed(logs.REQUIRED), "true_heading_rad"]
    rows = [[*reversed(line.split(",")), "nan"] for line in LINES]
    rows[2][columns.index("yaw_rate_radps")] = " NaN "
    rows[2][columns.index("bearing_rad")] = ""
    content = "\r\n".join(",".join(cells) for cells in [columns, *rows[:2], [], *rows[2:]])
    (tmp_path / "log.csv").write_bytes(b"\xef\xbb\xbf" + content.encode())
    found = logs.read(tmp_path / "log.csv")
    np.testing.assert_array_equal(found.time, [0.0, 0.5, 1.0, 1.5])
    np.testing.assert_array_equal(found.specific_force_b, [[0.1, 0.2]] * 4)
    np.testing.assert_array_equal(found.yaw_rate, [0.3, 0.3, np.nan, 0.3])
    np.testing.assert_array_equal(found.bearing, [0.4, 0.4, np.nan, 0.4])
    np.testing.assert_array_equal(found.samples.fix.age[:, 0], [np.nan, 0.25, np.nan, 0.25])
    np.testing.assert_array_equal(found.samples.imu.period[:, 0], [0.0, 0.5, 0.5, 0.5])
    assert np.isnan(found.heading).all()
    assert found.position_w is None


@pytest.mark.parametrize(
    ("line", "column", "cell", "reason"),
    [
        (4, "yaw_rate_radps", "fast", "'fast' is not a number"),
        (4, "yaw_rate_radps", "1_0", "'1_0' is not a number"),
        (2, "acceleration_x_mps2", "-inf", "an infinite value"),
        (4, "time_s", "", "a row must have a time"),
        (4, "time_s", "nan", "a row must have a time"),
        (4, "time_s", "0.5", "0.5 is not after the row before, 0.5"),
        (3, "time_s", "-1", "-1.0 is not after the row before, 0.0"),
        (5, "bearing_rad", "87.5", "87.5 is more than a turn, 2 pi rad; is it in degrees?"),
        (3, "fix_vx_mps", "", "empty, but other cells of its fix are not"),
        (3, "fix_time_s", "", "empty, but other cells of its fix are not"),
        (5, "fix_time_s", "1.75", "the fix is stamped 1.75, after the time of its row, 1.5"),
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
        (text(LINES[1]), "LOG: a log must have at least two rows of samples, this one has 1"),
        (text(*LINES).replace(",", ";"), "LOG, line 1: cells must be separated by commas"),
        (text(*LINES).replace("yaw_rate_radps", "yaw_rate"), "LOG: required columns are missing: yaw_rate_radps"),
        (text("0,0,0", header="time_s,fix_x_m,fix_y_m"), "LOG: required columns are missing: acceleration_x_mps2, "),
        (text(header=HEADER + ",battery_v"), f"LOG: unknown column 'battery_v'; known are {', '.join(logs.COLUMNS)}"),
        (text(header=HEADER + ",time_s"), "LOG: column time_s is there 2 times"),
        (text(header=HEADER + ",true_x_m"), "LOG: true_y_m missing; of true_x_m, true_y_m, all or none"),
        (
            text(header=HEADER + "".join(f",motor_current_{wheel}_a" for wheel in WHEELS[:3])),
            "LOG: motor_current_rear_right_a missing; of motor_current_front_left_a,",
        ),
        (text(*LINES[:2], "1.0,0.1"), "LOG, line 4: 2 cells, but the header has 10 columns"),
        (text(LINES[0], LINES[1] + ",5"), "LOG, line 3: 11 cells, but the header has 10 columns"),
        (text(LINES[0], '"1.0'), "LOG, line 3: "),
        (text(LINES[0], LINES[2]), f"LOG: there is no fix in columns {', '.join(logs.REQUIRED[5:])}; without one"),
        (text(LINES[0], LINES[1].replace("0.4", "")), "LOG: no row has both a fix and a bearing; estimators start"),
    ],
)
def test_a_wrong_file_is_refused(tmp_path, content, reason):
    assert refused(tmp_path, content).startswith(reason)


def test_a_wrong_place_is_refused(tmp_path, log):
    with pytest.raises(InputError, match=r"unknown extension '\.xlsx' of a log, allowed are \.csv and \.nc"):
        logs.read(tmp_path / "log.xlsx")
    with pytest.raises(InputError, match="unknown extension ''"):
        logs.write(tmp_path / "log", log)
    for name in ("log.csv", "log.nc"):
        with pytest.raises(InputError, match=f"cannot read the log .*{name}: No such file"):
            logs.read(tmp_path / name)
        (tmp_path / name).mkdir()
        with pytest.raises(InputError, match="cannot read the log"):
            logs.read(tmp_path / name)
        with pytest.raises(InputError, match="a folder is in the place of the log"):
            logs.require_writable(tmp_path / name)
    logs.require_writable(tmp_path / "new" / "log.csv")
    assert (tmp_path / "new").is_dir()
    with pytest.raises(InputError, match="unknown extension"):
        logs.require_writable(tmp_path / "log.txt")


def test_a_wrong_netcdf_file_is_refused(tmp_path, log):
    logs.write(tmp_path / "right.nc", log)
    with xr.open_dataset(tmp_path / "right.nc", engine="h5netcdf", decode_times=False) as dataset:
        right = dataset.load()

    def refusal(dataset):
        return refused(tmp_path, bytes(dataset.to_netcdf(engine="h5netcdf")), "wrong.nc")

    assert refused(tmp_path, text(*LINES), "text.nc") == "LOG: not a NetCDF-4 file"
    whole = (tmp_path / "right.nc").read_bytes()
    assert refused(tmp_path, whole[: len(whole) // 2], "half.nc") == "LOG: not a NetCDF-4 file"
    assert refusal(right.drop_vars("bearing_rad")) == "LOG: required columns are missing: bearing_rad"
    assert refusal(right.assign(battery_v=("sample", log.time))).startswith("LOG: unknown column 'battery_v'")
    assert (
        refusal(right.assign(bearing_rad=("time", log.bearing)))
        == "LOG, column bearing_rad: float64 over (time) given, it must be numbers over (sample)"
    )
    late = log.time.copy()
    late[7] = 0.0
    message = refusal(right.assign(time_s=("sample", late)))
    assert message == "LOG, sample 7, column time_s: 0.0 is not after the row before, 0.216"


def test_a_log_that_would_be_refused_is_not_written(tmp_path, log):
    nothing = np.full_like(log.fix_time, np.nan)
    silent = dataclasses.replace(
        log,
        fix_time=nothing,
        fix_position_w=np.stack([nothing] * 2, -1),
        fix_velocity_w=np.stack([nothing] * 2, -1),
    )
    with pytest.raises(InputError, match="there is no fix"):
        logs.write(tmp_path / "log.csv", silent)
    assert list(tmp_path.iterdir()) == []


NUMBERS = st.floats(allow_infinity=False, allow_nan=False)
SAMPLES = st.floats(allow_infinity=False)  # NaN: missing


@settings(max_examples=40)
@given(
    times=st.lists(st.floats(0.0, 2e9), min_size=2, max_size=6, unique=True),
    samples=st.lists(SAMPLES, min_size=6 * 9, max_size=6 * 9),
    fixes=st.lists(NUMBERS, min_size=6 * 4, max_size=6 * 4),
    fixed=st.lists(st.booleans(), min_size=6, max_size=6),
    extension=st.sampled_from(["csv", "nc"]),
)
def test_every_log_survives(times, samples, fixes, fixed, extension):
    count = len(times)
    received = np.array(fixed[:count]) | (np.arange(count) == 0)
    values = np.array(samples).reshape(6, 9)[:count]
    fix = np.where(received[:, None], np.array(fixes).reshape(6, 4)[:count], np.nan)
    time = np.sort(times)
    written = logs.Log(
        time=time,
        specific_force_b=values[:, :2],
        yaw_rate=values[:, 2],
        bearing=np.clip(np.where(received, np.nan_to_num(values[:, 3]), values[:, 3]), -6.0, 6.0),
        fix_time=np.where(received, time, np.nan),
        fix_position_w=fix[:, :2],
        fix_velocity_w=fix[:, 2:],
        wheel_speed=values[:, 4:8],
        heading=values[:, 8],
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"log.{extension}"
        logs.write(path, written)
        equal(logs.read(path), written)


@given(line=st.integers(2, 5), column=st.sampled_from(logs.REQUIRED), cell=st.text("0123456789.-e xnaif", max_size=6))
def test_any_cell_is_read_or_named(line, column, cell):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.csv"
        path.write_text(edited(line, column, cell))
        message = None
        try:
            logs.read(path)
        except InputError as error:
            message = str(error)
        # The row after a late one, and the other cells of a fix, may be where it shows.
        assert message is None or re.fullmatch(rf"{re.escape(str(path))}, line [2-5], column \w+: .+", message)


def test_the_example_of_the_documentation_is_a_log(tmp_path):
    document = DOCUMENT.read_text(encoding="utf-8")
    example = re.search(r"```csv\n(.*?)```", document, re.DOTALL).group(1)
    assert len(example.splitlines()) == 10
    (tmp_path / "my_robot.csv").write_text(example)
    found = logs.read(tmp_path / "my_robot.csv")
    assert np.isfinite(found.fix_time).sum() == 1
    assert np.isnan(found.bearing).sum() == 1
    # The error that is shown there.
    lines = [line.replace(",-0.209,", ",,") for line in example.splitlines()]
    message = refused(tmp_path, "\n".join(lines), "my_robot.csv")
    assert f"dynabot: {message}".replace("LOG", "my_robot.csv") in document
    described = [name for name in logs.COLUMNS if not re.search("wheel|motor", name)]
    assert all(f"`{name}`" in document for name in described)
