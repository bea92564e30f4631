"""NetCDF files, written a piece at a time: equal content gives equal bytes, and memory does not grow with the file."""

import contextlib
import errno
import io
import os
import shutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import numpy as np
import numpy.typing as npt
import xarray as xr

_MARGIN = 2**20  # of a file beside its values [bytes]


@dataclass(frozen=True)
class Variable:
    """A variable of a file before its values are known."""

    dimensions: Sequence[str]
    attributes: Mapping[str, Any] = field(default_factory=dict)
    dtype: Any = np.float64  # where nothing is put, float is NaN


class Writer:
    """A file that is being written."""

    def __init__(self, file: h5netcdf.File) -> None:
        self._file = file

    def put(self, name: str, index: Any, values: Any) -> None:
        """Writes a part of a variable, e.g. at `(case, slice(0, 50))`."""
        self._file.variables[name][index] = values


@contextlib.contextmanager
def writing(
    target: Path | io.BytesIO,
    sizes: Mapping[str, int],
    coordinates: Mapping[str, tuple[Sequence[str], Any, Mapping[str, Any]]],
    variables: Mapping[str, Variable],
    attributes: Mapping[str, Any],
) -> Iterator[Writer]:
    """Makes a file, and yields it for the values of its variables.

    Args:
        target: Of the file, or of its bytes.
        sizes: Of the dimensions.
        coordinates: Dimensions, values and attributes of each.
        variables: All others.
        attributes: Of the file.

    Raises:
        OSError: If there is no room for it: the library would not survive a full disk.
    """
    if isinstance(target, Path):
        _require_room(target, sizes, variables)
    with h5netcdf.File(target, "w") as file:
        # In the order of their names, so that a file that is read and written again is the same.
        file.dimensions = dict(sorted(sizes.items()))
        for name, (dimensions, values, told) in sorted(coordinates.items()):
            array = np.asarray(values)
            made = _made(file, name, Variable(dimensions, told, array.dtype))
            made[...] = array.astype(object) if array.dtype.kind == "U" else array
        # How NetCDF says which variables are coordinates, of those that share a dimension with them.
        beside = {
            name: set(dimensions) for name, (dimensions, _, _) in sorted(coordinates.items()) if [*dimensions] != [name]
        }
        for name, variable in variables.items():
            made = _made(file, name, variable)
            if all(made.shape) and made.dtype.kind in "fiub":
                made[(0,) * made.ndim] = (
                    np.nan if made.dtype.kind == "f" else 0
                )  # has its place now, whoever is put first
            if near := [other for other, dimensions in beside.items() if dimensions <= set(variable.dimensions)]:
                made.attrs["coordinates"] = " ".join(near)
        for name, value in attributes.items():
            file.attrs[name] = value
        yield Writer(file)


def content(dataset: xr.Dataset) -> bytes:
    """Returns a Dataset as the bytes of a file."""
    buffer = io.BytesIO()
    write(dataset, buffer)
    return buffer.getvalue()


def write(dataset: xr.Dataset, target: Path | io.BytesIO) -> None:
    """Writes a Dataset.

    Args:
        dataset: Of numbers and texts.
        target: Of the file, or of its bytes.

    Raises:
        OSError: If there is no room for it.
    """
    coordinates = {
        str(name): ([str(one) for one in array.dims], array.values, array.attrs)
        for name, array in dataset.coords.items()
    }
    variables = {
        str(name): Variable([str(one) for one in array.dims], array.attrs, array.dtype)
        for name, array in dataset.data_vars.items()
    }
    sizes = {str(name): size for name, size in dataset.sizes.items()}
    with writing(target, sizes, coordinates, variables, dataset.attrs) as file:
        for name in variables:
            values = dataset[name].values
            file.put(name, ..., values.astype(object) if values.dtype.kind == "U" else values)


def _made(file: h5netcdf.File, name: str, variable: Variable) -> Any:
    dtype = np.dtype(variable.dtype)
    kind: npt.DTypeLike = h5py.string_dtype() if dtype.kind in "UO" else dtype
    made = file.create_variable(name, tuple(variable.dimensions), kind, fillvalue=np.nan if dtype.kind == "f" else None)
    for key, value in variable.attributes.items():
        made.attrs[key] = value
    return made


def _require_room(target: Path, sizes: Mapping[str, int], variables: Mapping[str, Variable]) -> None:
    needed = _MARGIN
    for variable in variables.values():
        needed += np.dtype(variable.dtype).itemsize * int(np.prod([sizes[name] for name in variable.dimensions]))
    if shutil.disk_usage(target.parent).free < needed:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(target))
