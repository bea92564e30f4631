"""Logs of one robot's sensors as files, CSV or NetCDF; `docs/logs.md` is about them.

One row per inertial sample. Fixes stand in the row of the sample that they had arrived before, with the time stamped on
them. What a row does not have is empty in CSV, NaN in NetCDF. Columns carry their unit in their name:

    time_s                                                                     increasing
    acceleration_x_mps2, acceleration_y_mps2, yaw_rate_radps                   means since the row before
    bearing_rad                                                                now
    fix_time_s, fix_x_m, fix_y_m, fix_vx_mps, fix_vy_mps                       where one has arrived
    wheel_speed_front_left_radps ... motor_current_front_left_a ...            optional, four and four
    true_x_m, true_y_m, true_heading_rad                                       optional

Values survive writing and reading to the last bit.
"""

import csv
import io
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
import numpy.typing as npt
import xarray as xr

from dynabot_mj import files
from dynabot_mj.arrays import Array, measured
from dynabot_mj.errors import InputError
from dynabot_mj.ground_truth import GroundTruth
from dynabot_mj.replay import Samples
from dynabot_mj.scene import WHEELS
from dynabot_mj.sensors import SensorOptions
from estimation.measurements import GpsFix, ImuSample

_TURN = 2.0 * np.pi
_ROUNDING = 1e-9  # by which a fix's stamp may seem to be later than its row [s]


@dataclass(frozen=True, kw_only=True)
class Log:
    """What the sensors of one robot said in N rows; NaN where a sample is missing."""

    time: Array  # (N,) increasing [s]
    specific_force_b: Array  # (N, 2) mean since the row before, ahead and to the left [m/s^2]
    yaw_rate: Array  # (N,) mean since the row before, counter-clockwise [rad/s]
    bearing: Array  # (N,) from the world's x axis, counter-clockwise [rad]
    fix_time: Array  # (N,) stamped on the fix that has arrived since the row before; NaN: none has [s]
    fix_position_w: Array  # (N, 2) [m]
    fix_velocity_w: Array  # (N, 2) [m/s]
    wheel_speed: Array | None = None  # (N, 4), order of `scene.WHEELS` [rad/s]
    motor_current: Array | None = None  # (N, 4), the same order [A]
    position_w: Array | None = None  # (N, 2) true [m]
    heading: Array | None = None  # (N,) true [rad]

    @property
    def samples(self) -> Samples:
        """The same as samples of a single run."""
        return Samples(
            time=self.time,
            imu=ImuSample(
                period=np.diff(self.time, prepend=self.time[:1])[:, None],
                specific_force_b=self.specific_force_b[:, None],
                yaw_rate=self.yaw_rate[:, None],
                bearing=self.bearing[:, None],
            ),
            fix=GpsFix(
                received=np.isfinite(self.fix_time)[:, None],
                position_w=self.fix_position_w[:, None],
                velocity_w=self.fix_velocity_w[:, None],
                age=(self.time - self.fix_time)[:, None],
            ),
        )


@dataclass(frozen=True, kw_only=True)
class _Quantity:
    """A field of `Log` in a file."""

    columns: tuple[str, ...]
    unit: str
    meaning: str
    optional: bool = False


_QUANTITIES = {
    "time": _Quantity(columns=("time_s",), unit="s", meaning="time of the sample"),
    "specific_force_b": _Quantity(
        columns=("acceleration_x_mps2", "acceleration_y_mps2"),
        unit="m s-2",
        meaning="mean specific force since the sample before, x ahead, y to the left",
    ),
    "yaw_rate": _Quantity(
        columns=("yaw_rate_radps",), unit="rad s-1", meaning="mean since the sample before, counter-clockwise"
    ),
    "bearing": _Quantity(columns=("bearing_rad",), unit="rad", meaning="from the world's x axis, counter-clockwise"),
    "fix_time": _Quantity(columns=("fix_time_s",), unit="s", meaning="stamped on the fix that has arrived"),
    "fix_position_w": _Quantity(columns=("fix_x_m", "fix_y_m"), unit="m", meaning="position of the fix"),
    "fix_velocity_w": _Quantity(columns=("fix_vx_mps", "fix_vy_mps"), unit="m s-1", meaning="velocity of the fix"),
    "wheel_speed": _Quantity(
        columns=tuple(f"wheel_speed_{wheel}_radps" for wheel in WHEELS),
        unit="rad s-1",
        meaning="positive ahead",
        optional=True,
    ),
    "motor_current": _Quantity(
        columns=tuple(f"motor_current_{wheel}_a" for wheel in WHEELS),
        unit="A",
        meaning="positive when it drives ahead",
        optional=True,
    ),
    "position_w": _Quantity(
        columns=("true_x_m", "true_y_m"), unit="m", meaning="true position of the centre", optional=True
    ),
    "heading": _Quantity(columns=("true_heading_rad",), unit="rad", meaning="true heading", optional=True),
}
_FIX = tuple(name for field in ("fix_time", "fix_position_w", "fix_velocity_w") for name in _QUANTITIES[field].columns)

COLUMNS = tuple(name for one in _QUANTITIES.values() for name in one.columns)
REQUIRED = tuple(name for one in _QUANTITIES.values() if not one.optional for name in one.columns)


def from_run(samples: Samples, truth: GroundTruth, run: int) -> Log:
    """Returns the log of one recorded run, with the truth and, where there are wheels, what their converters read.

    Args:
        samples: Of `replay.record`.
        truth: The drives that they are of.
        run: Its index.
    """
    fix, wheels = samples.fix, SensorOptions().wheels
    # To estimators a fix that is not finite is none.
    values = np.concatenate([fix.position_w[:, run], fix.velocity_w[:, run], fix.age[:, run, None]], axis=-1)
    received = fix.received[:, run] & np.isfinite(values).all(axis=-1)
    grid = np.rint((samples.time - truth.time[0]) / truth.interval).astype(np.intp)

    def read(values: Array | None, resolution: float) -> Array | None:
        return None if values is None else measured(values[grid, run], resolution)

    return Log(
        time=samples.time,
        specific_force_b=_finite(samples.imu.specific_force_b[:, run]),
        yaw_rate=_finite(samples.imu.yaw_rate[:, run]),
        bearing=_finite(samples.imu.bearing[:, run]),
        fix_time=np.where(received, samples.time - fix.age[:, run], np.nan),
        fix_position_w=np.where(received[:, None], fix.position_w[:, run], np.nan),
        fix_velocity_w=np.where(received[:, None], fix.velocity_w[:, run], np.nan),
        wheel_speed=read(truth.wheel_speed, wheels.speed),
        motor_current=read(truth.motor_current, wheels.current),
        position_w=truth.position_w[grid, run],
        heading=truth.heading[grid, run],
    )


def require_writable(path: Path) -> None:
    """Makes sure that a log can be written to a place, before any work.

    Raises:
        InputError: If its name has no known extension, or its folder cannot be written to.
    """
    _require_extension(path)
    files.require_writable(path.parent)
    if path.is_dir():
        raise InputError(f"{path}: a folder is in the place of the log")


def write(path: Path, log: Log) -> None:
    """Writes a log; equal logs give equal bytes.

    Args:
        path: Its name says the format, .csv or .nc.
        log: What to write.

    Raises:
        InputError: If the name has another extension, or if `read` would refuse the log.
    """
    _require_extension(path)
    columns: dict[str, Array] = {}
    for field, quantity in _QUANTITIES.items():
        values: Array | None = getattr(log, field)
        if values is not None:
            columns |= zip(quantity.columns, values.reshape(len(log.time), -1).T, strict=True)
    _check(columns, path, lambda index: f"sample {index}")
    files.write(path, _csv(columns) if path.suffix == ".csv" else _netcdf(columns))


def read(path: Path) -> Log:
    """Reads a log.

    Args:
        path: CSV or NetCDF, by its extension.

    Raises:
        InputError: If it cannot be read, or estimators could not be run over it; names the line as an editor counts
            them (of NetCDF the sample, counted from 0) and the column.
    """
    _require_extension(path)
    columns, place = _read_csv(path) if path.suffix == ".csv" else _read_netcdf(path)
    _check(columns, path, place)
    fields = {}
    for field, quantity in _QUANTITIES.items():
        if quantity.columns[0] in columns:
            values = [columns[name] for name in quantity.columns]
            fields[field] = values[0] if len(values) == 1 else np.stack(values, axis=-1)
    return Log(**fields)


_Place = Callable[[int], str]  # names a row to a reader, from its index


def _read_csv(path: Path) -> tuple[dict[str, Array], _Place]:
    try:
        text = _content(path).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not a text file in UTF-8") from error
    if "\0" in text:
        raise InputError(f"{path}: not a text file in UTF-8")
    reader = csv.reader(io.StringIO(text, newline=None), strict=True)
    header: list[str] = []
    rows: list[list[float]] = []
    lines: list[int] = []
    try:
        for cells in reader:
            if not cells:
                continue  # a blank line
            if not header:
                header = [cell.strip() for cell in cells]
                _check_header(header, path)
                continue
            where = f"{path}, line {reader.line_num}"
            if len(cells) != len(header):
                raise InputError(f"{where}: {len(cells)} cells, but the header has {len(header)} columns")
            rows.append([_number(cell, f"{where}, column {name}") for cell, name in zip(cells, header, strict=True)])
            lines.append(reader.line_num)
    except csv.Error as error:
        raise InputError(f"{path}, line {reader.line_num}: {error}") from error
    if not header:
        raise InputError(f"{path}: the file is empty")
    values = np.array(rows, dtype=np.float64).reshape(-1, len(header))
    return dict(zip(header, values.T.copy(), strict=True)), lambda index: f"line {lines[index]}"


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot read the log {path}: {error.strerror}") from error


def _number(cell: str, where: str) -> float:
    """Returns a cell's value, NaN where it is empty."""
    text = cell.strip()
    try:
        if "_" in text:  # which Python's numbers may have
            raise ValueError
        return float(text or "nan")
    except ValueError:
        raise InputError(f"{where}: {text!r} is not a number") from None


def _read_netcdf(path: Path) -> tuple[dict[str, Array], _Place]:
    content = io.BytesIO(_content(path))
    try:
        # h5netcdf complains on standard error about a file that does not even open.
        with h5py.File(content, "r"):
            pass
        # Times are seconds, which xarray would make dates and durations of.
        with xr.open_dataset(content, engine="h5netcdf", decode_times=False) as dataset:
            dataset.load()
    except Exception as error:  # which one depends on where the file is broken
        raise InputError(f"{path}: not a NetCDF-4 file") from error
    _check_header([str(name) for name in dataset.variables], path)
    for name, variable in dataset.variables.items():
        if variable.dims != ("sample",) or variable.dtype.kind not in "fiu":
            given = f"{variable.dtype} over ({', '.join(map(str, variable.dims))})"
            raise InputError(f"{path}, column {name}: {given} given, it must be numbers over (sample)")
    columns = {str(name): variable.values.astype(np.float64) for name, variable in dataset.variables.items()}
    return columns, lambda index: f"sample {index}"


def _check_header(names: list[str], path: Path) -> None:
    """Refuses what is missing, unknown or there twice."""
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
    for quantity in _QUANTITIES.values():
        lacking = [name for name in quantity.columns if name not in names]
        if 0 < len(lacking) < len(quantity.columns):
            raise InputError(f"{path}: {', '.join(lacking)} missing; of {', '.join(quantity.columns)}, all or none")


def _check(columns: Mapping[str, Array], path: Path, place: _Place) -> None:
    """Refuses what no estimator could be run over, each time the first row with such a thing."""

    def refuse(bad: npt.NDArray[np.bool_], column: str, reason: Callable[[int], str]) -> None:
        if bad.any():
            index = int(bad.argmax())
            raise InputError(f"{path}, {place(index)}, column {column}: {reason(index)}")

    time, fix_time = columns["time_s"], columns["fix_time_s"]
    if len(time) < 2:
        raise InputError(f"{path}: a log must have at least two rows of samples, this one has {len(time)}")
    for name, values in columns.items():
        refuse(np.isinf(values), name, lambda index: "an infinite value")
    refuse(np.isnan(time), "time_s", lambda index: "a row must have a time")
    late = np.diff(time, prepend=-np.inf) <= 0.0
    refuse(late, "time_s", lambda i: f"{time[i]} is not after the row before, {time[i - 1]}")
    bearing = columns["bearing_rad"]
    refuse(
        np.abs(bearing) > _TURN,
        "bearing_rad",
        lambda i: f"{bearing[i]} is more than a turn, 2 pi rad; is it in degrees?",
    )
    given = np.stack([np.isfinite(columns[name]) for name in _FIX])
    for name in _FIX:
        refuse(
            given.any(axis=0) & np.isnan(columns[name]), name, lambda index: "empty, but other cells of its fix are not"
        )
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
    if np.isnan(bearing[fixed]).all():
        raise InputError(f"{path}: no row has both a fix and a bearing; estimators start in such a row")


def _csv(columns: Mapping[str, Array]) -> bytes:
    lines = [",".join(columns)]
    # The shortest digits that are read back as the same number.
    lines += [
        ",".join("" if value != value else repr(value) for value in row)
        for row in np.stack(list(columns.values()), axis=-1).tolist()
    ]
    return ("\n".join(lines) + "\n").encode()


def _netcdf(columns: Mapping[str, Array]) -> bytes:
    described = {name: one for one in _QUANTITIES.values() for name in one.columns}
    variables = {
        name: ("sample", values, {"units": described[name].unit, "long_name": described[name].meaning})
        for name, values in columns.items()
    }
    dataset = xr.Dataset(variables, attrs={"title": "Log of a robot's sensors"})
    return bytes(dataset.to_netcdf(engine="h5netcdf"))


def _finite(values: Array) -> Array:
    """Returns samples with those missing that are not finite: to estimators they are the same."""
    return np.where(np.isfinite(values), values, np.nan)


def _require_extension(path: Path) -> None:
    if path.suffix not in (".csv", ".nc"):
        raise InputError(f"{path}: unknown extension {path.suffix!r} of a log, allowed are .csv and .nc")
