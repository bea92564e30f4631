"""The columns of a log in files, CSV or NetCDF by their extension; `docs/logs.md` is about them.

What is missing is empty in CSV, NaN in NetCDF. Values survive writing and reading to the last bit.
"""

import csv
import io
from collections.abc import Mapping
from pathlib import Path

import h5py
import numpy as np
import xarray as xr

from dynabot_mj.common import netcdf
from dynabot_mj.common.arrays import Array
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.host import files
from dynabot_mj.sensing.logs.columns import QUANTITIES, Place, check, check_header


def require_writable(path: Path) -> None:
    """Makes sure that a log can be written to a place, before any work.

    Raises:
        InputError: If its name has no known extension, or its folder cannot be written to.
    """
    _require_extension(path)
    files.require_writable(path.parent)
    if path.is_dir():
        raise InputError(f"{path}: a folder is in the place of the log")


def write(path: Path, columns: Mapping[str, Array]) -> None:
    """Writes a log; equal columns give equal bytes.

    Args:
        path: Its name says the format.
        columns: By name, (N,) each.

    Raises:
        InputError: If the name has another extension, or if `read` would refuse the columns.
    """
    _require_extension(path)
    check(columns, path, _sample)
    files.write(path, _csv(columns) if path.suffix.lower() == ".csv" else _netcdf(columns))


def read(path: Path) -> dict[str, Array]:
    """Reads the columns of a log, (N,) each.

    Args:
        path: Its name says the format.

    Raises:
        InputError: If it cannot be read, or estimators could not be run over it; names the line as an editor counts
            them (of NetCDF the sample, counted from 0) and the column.
    """
    _require_extension(path)
    columns, place = _read_csv(path) if path.suffix.lower() == ".csv" else _read_netcdf(path)
    check(columns, path, place)
    return columns


def _read_csv(path: Path) -> tuple[dict[str, Array], Place]:
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
                check_header(header, path)
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


def _number(cell: str, where: str) -> float:
    """Returns a cell's value, NaN where it is empty."""
    text = cell.strip()
    try:
        if "_" in text:  # which Python's numbers may have
            raise ValueError
        return float(text or "nan")
    except ValueError:
        raise InputError(f"{where}: {text!r} is not a number") from None


def _read_netcdf(path: Path) -> tuple[dict[str, Array], Place]:
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
    check_header([str(name) for name in dataset.variables], path)
    for name, variable in dataset.variables.items():
        if variable.dims != ("sample",) or variable.dtype.kind not in "fiu":
            given = f"{variable.dtype} over ({', '.join(map(str, variable.dims))})"
            raise InputError(f"{path}, column {name}: {given} given, it must be numbers over (sample)")
    columns = {str(name): variable.values.astype(np.float64) for name, variable in dataset.variables.items()}
    return columns, _sample


def _csv(columns: Mapping[str, Array]) -> bytes:
    lines = [",".join(columns)]
    # The shortest digits that are read back as the same number.
    lines += [
        ",".join("" if value != value else repr(value) for value in row)
        for row in np.stack(list(columns.values()), axis=-1).tolist()
    ]
    return ("\n".join(lines) + "\n").encode()


def _netcdf(columns: Mapping[str, Array]) -> bytes:
    described = {name: one for one in QUANTITIES.values() for name in one.columns}
    variables = {
        name: ("sample", values, {"units": described[name].unit, "long_name": described[name].meaning})
        for name, values in columns.items()
    }
    dataset = xr.Dataset(variables, attrs={"title": "Log of a robot's sensors"})
    return netcdf.content(dataset)


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot read the log {path}: {error.strerror}") from error


def _sample(index: int) -> str:
    return f"sample {index}"


def _require_extension(path: Path) -> None:
    if path.suffix.lower() not in (".csv", ".nc"):
        raise InputError(f"{path}: unknown extension {path.suffix!r} of a log, allowed are .csv and .nc")
