"""A study: cases x trials -> one xarray Dataset, run, saved, read back, and told apart by the points of its grid.

The Dataset carries the science (configuration, versions, seed); how it was executed is the caller's to note elsewhere,
so that equal studies are equal bytes.
"""

import io
import json
from pathlib import Path

import xarray as xr

from dynabot_mj.common import netcdf
from dynabot_mj.common.arrays import Progress
from dynabot_mj.study import campaign, checks, configuration, layout, scenario, trial_chunks
from dynabot_mj.study.campaign import Campaign
from dynabot_mj.study.chunk_folder import Results
from dynabot_mj.study.execution import Execution, ShareWatch, execute
from dynabot_mj.study.scenario import Scenario

_HERE = Execution()  # in this process


def run(setup: Scenario, execution: Execution = _HERE, progress: Progress = lambda share: None) -> xr.Dataset:
    """Runs all trials of all cases of a study.

    Args:
        setup: The study's configuration.
        execution: How to execute it.
        progress: Called now and then with the share of the work that is done.

    Raises:
        InputError: If the configuration contradicts itself.

    Returns:
        Dimensions `case`, `trial`, `robot`, `axis`, `recorded`, `time`; each variable states its unit. Scores of
        diverged trials are NaN.

    Example:
        >>> setup = dy.build_scenario({"trials": 2, "duration": 1.0, "plants": ["particle"], "estimators": ["gps"]})
        >>> results = dy.run(setup)
        >>> results.closest.dims, results.closest.shape, results.closest.units
        (('case', 'trial'), (1, 2), 'm')
    """
    checks.check(setup)
    made = campaign.single(setup)
    return whole(made, execute(trial_chunks.chunks(made), execution, ShareWatch(progress)))


def whole(made: Campaign, results: Results) -> xr.Dataset:
    """Returns the Dataset of a campaign whose chunks are done, in memory."""
    buffer = io.BytesIO()
    layout.write(made, results, buffer)
    buffer.seek(0)
    return _read(buffer)


def save(dataset: xr.Dataset, path: Path | str) -> None:
    """Writes a Dataset as NetCDF; equal Datasets give equal bytes.

    Args:
        dataset: Of `run`.
        path: Of the file.

    Raises:
        OSError: If it cannot be written, as on a full disk, which the NetCDF library itself would not survive.

    Example:
        >>> from pathlib import Path
        >>> setup = dy.build_scenario({"trials": 2, "duration": 1.0, "plants": ["particle"], "estimators": ["gps"]})
        >>> dy.save(dy.run(setup), "study.nc")
        >>> Path("study.nc").is_file()
        True
    """
    netcdf.write(dataset, Path(path))


def load(path: Path | str) -> xr.Dataset:
    """Reads a Dataset that `save` wrote, whole.

    One of an older version, which has no first passages, is judged as today: hulls that touched fail the common
    completion, where it counted centres.

    Args:
        path: Of the file.

    Raises:
        OSError: If it cannot be read.
        ValueError: If it is no NetCDF file.

    Example:
        >>> setup = dy.build_scenario({"trials": 2, "duration": 1.0, "plants": ["particle"], "estimators": ["gps"]})
        >>> results = dy.run(setup)
        >>> dy.save(results, "study.nc")
        >>> dy.load("study.nc").identical(results)
        True
    """
    return _read(Path(path))


def opened(path: Path) -> xr.Dataset:
    """Opens a Dataset whose values are read when they are asked for, and not kept."""
    return _indexed(xr.open_dataset(path, engine="h5netcdf", cache=False))


def _read(source: Path | io.BytesIO) -> xr.Dataset:
    with xr.open_dataset(source, engine="h5netcdf") as dataset:
        study = dataset.load()
    study = _indexed(study)
    if "contact" not in study.variables and {"completion_common", "collision_footprint"} <= set(study.variables):
        common = study.completion_common
        study["completion_common"] = common.where(common.isnull() | (study.collision_footprint != 1.0), 0.0)
    return study


def missing(study: xr.Dataset) -> list[str]:
    """Returns which of the variables that every version writes a Dataset lacks."""
    expected = ("diverged", *(name for name in layout.VARIABLES if name not in layout.LATER), "error_lag")
    return [name for name in expected if name not in study.variables]


def _indexed(study: xr.Dataset) -> xr.Dataset:
    """Lets cases of a campaign be selected by what they differ in, as in `study.sel(robots=5)`."""
    if "grid" not in study.attrs:
        return study
    for name in [str(one) for one, array in study.coords.items() if array.dims == ("case",)]:
        if name not in study.xindexes:
            study = study.set_xindex(name)
    return study


def campaign_of(study: xr.Dataset, origin: str) -> Campaign:
    """Returns the campaign that a Dataset is of.

    Raises:
        InputError: If its configuration is none.
    """
    text = f"{study.attrs['configuration']}\n{study.attrs.get('grid', '')}"
    return campaign.parse(text, origin)


def points(study: xr.Dataset) -> list[xr.Dataset]:
    """Returns the studies that a campaign consists of, one for each point of its grid, each as if run by itself."""
    if "grid" not in study.attrs:
        return [study]
    made = campaign_of(study, "the study's configuration")
    inputs = json.loads(study.attrs["inputs"])
    found = []
    for index, point in enumerate(made.points):
        setup = point.setup
        # By an index of its own a coordinate can be selected by; a study of one point has none of these.
        part = study.reset_index([name for name in study.xindexes if name not in study.sizes])
        part = part.isel(case=study.point.values == index, robot=slice(0, setup.robots))
        end = scenario.duration(setup)
        part = part.isel(time=part.time.values <= end + 1e-9).drop_vars(["point", *made.names.values()])
        attributes = {
            **{name: value for name, value in study.attrs.items() if name != "grid"},
            "configuration": configuration.dump(setup),
            "inputs": json.dumps(inputs[index]),
            "controller": setup.controller,
            "seed": setup.seed,
            "duration": end,
        }
        part = part.assign_coords(case=[case.label for case in scenario.cases(setup)])
        part.attrs = attributes
        found.append(part)
    return found
