"""A study: cases x trials -> one xarray Dataset.

The Dataset carries the science (configuration, versions, seed); how it was executed is the caller's to note elsewhere,
so that equal studies are equal bytes.
"""

import json
import operator
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from dynabot_mj.common import netcdf
from dynabot_mj.common.arrays import Progress
from dynabot_mj.formation.scorer import Scores
from dynabot_mj.study import checks, configuration, provenance, scenario
from dynabot_mj.study.execution import Execution, execute
from dynabot_mj.study.scenario import Case, Scenario
from dynabot_mj.trial.judge import Outcome

_HERE = Execution()  # in this process

# Of each outcome: where it is, its dimensions behind `case`, unit and meaning; scores state their own. All are NaN for
# trials that diverged.
_TRIAL = ("trial",)
_LAGS = ("trial", "lag")
_VARIABLES = {
    **{
        one.name: (f"scores.{one.name}", _TRIAL, one.metadata["unit"], one.metadata["meaning"])
        for one in fields(Scores)
    },
    "hull_contact": ("hull_contact", _TRIAL, "1", "1: a hull touched something; NaN for point masses"),
    "wheel_slip": ("wheel_slip", _TRIAL, "m/s", "largest slip of a tyre along its wheel; NaN for point masses"),
    "message_age": ("message_age", _TRIAL, "s", "mean age of the neighbours' positions when acted on"),
    "position_autocovariance": ("errors.position", _LAGS, "m2", "of the believed positions' errors, per axis"),
    "velocity_autocovariance": ("errors.velocity", _LAGS, "m2 s-2", "of the believed velocities' errors, per axis"),
    "heading_autocovariance": ("errors.heading", _LAGS, "rad2", "of the headings' errors that local laws have"),
    "stale": ("errors.stale", _TRIAL, "1", "share of the samples at which a robot had no fresh belief of its own"),
    "restarts": ("errors.restarts", _TRIAL, "1", "estimators that broke down and were started again"),
    "final_position_w": ("final_position_w", ("trial", "robot", "axis"), "m", "position of the centre at the end"),
    "final_heading": ("final_heading", ("trial", "robot"), "rad", "heading at the end"),
    "trajectory_w": ("trajectory_w", ("recorded", "time", "robot", "axis"), "m", "path of the centre"),
}
_LATER = tuple(one.name for one in fields(Scores) if not one.metadata["always"])  # which older studies do not have


def run(setup: Scenario, execution: Execution = _HERE, progress: Progress = lambda share: None) -> xr.Dataset:
    """Runs all trials of all cases of a study.

    Args:
        setup: The study's configuration.
        execution: How to execute it.
        progress: Called now and then.

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
    return _dataset(setup, execute(setup, execution, progress))


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
    Path(path).write_bytes(netcdf.content(dataset))


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
    with xr.open_dataset(path, engine="h5netcdf") as dataset:
        study = dataset.load()
    if "contact" not in study.variables and {"completion_common", "collision_footprint"} <= set(study.variables):
        common = study.completion_common
        study["completion_common"] = common.where(common.isnull() | (study.collision_footprint != 1.0), 0.0)
    return study


def missing(study: xr.Dataset) -> list[str]:
    """Returns which of the variables that every version writes a Dataset lacks."""
    expected = ("diverged", *(name for name in _VARIABLES if name not in _LATER), "error_lag")
    return [name for name in expected if name not in study.variables]


def _dataset(setup: Scenario, by_case: Mapping[Case, list[Outcome]]) -> xr.Dataset:
    """Joins the chunks of each case along the trials, and the cases."""
    cases = list(by_case)

    def joined(path: str) -> npt.NDArray[Any]:
        read = operator.attrgetter(path)
        return np.stack([np.concatenate([read(outcome) for outcome in by_case[case]]) for case in cases])

    diverged = joined("diverged")
    variables: dict[str, Any] = {
        "diverged": (("case", *_TRIAL), diverged.astype(np.int8), {"units": "1", "long_name": "1: broke down"})
    }
    for name, (path, dimensions, unit, meaning) in _VARIABLES.items():
        values = joined(path).astype(float)
        broken = diverged if "trial" in dimensions else diverged[:, : values.shape[1]]
        values[broken] = np.nan
        variables[name] = (("case", *dimensions), values, {"units": unit, "long_name": meaning})
    rows = [scenario.method(setup, case.estimator) for case in cases]
    periods = np.array([scenario.periods(setup, case.estimator) for case in cases]) * setup.processor.tick
    variables["error_lag"] = (("case", "lag"), joined("errors.lag")[:, 0], {"units": "s", "long_name": "of the above"})
    variables["sample_period"] = ("case", periods[:, 0], {"units": "s"})
    variables["control_period"] = ("case", periods[:, 1], {"units": "s"})
    variables["alpha_h"] = ("case", [row.alpha_h for row in rows], {"units": "N m"})
    variables["alpha_d"] = ("case", [row.alpha_d for row in rows], {"units": "N m"})
    first = next(iter(by_case.values()))[0]
    coordinates = {
        "case": [case.label for case in cases],
        "plant": ("case", [case.plant for case in cases]),
        "perception": ("case", [case.perception or "" for case in cases]),
        "estimator": ("case", [case.estimator for case in cases]),
        "velocity": ("case", [scenario.velocity(setup, case) for case in cases]),
        "trial": np.arange(setup.first_trial, setup.first_trial + setup.trials),
        "time": ("time", first.time, {"units": "s"}),
        "axis": ["x", "y"],
    }
    attributes = {
        "title": "Formation control under limited computation: point masses and rigid bodies",
        "configuration": configuration.dump(setup),
        "inputs": json.dumps(provenance.inputs(setup)),
        "controller": setup.controller,
        "versions": provenance.versions(),
        "seed": setup.seed,
        "duration": scenario.duration(setup),
    }
    return xr.Dataset(variables, coordinates, attributes)
