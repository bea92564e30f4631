"""A study: cases x trials -> one xarray Dataset.

The Dataset carries the science (configuration, versions, seed); how it was executed is the caller's to note elsewhere,
so that equal studies are equal bytes. It is written chunk by chunk: memory does not grow with the number of trials.
"""

import io
import json
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from dynabot_mj.common import columns as records
from dynabot_mj.common import netcdf
from dynabot_mj.common.arrays import Array, Progress
from dynabot_mj.common.columns import Columns
from dynabot_mj.common.netcdf import Variable
from dynabot_mj.formation.scorer import Scores
from dynabot_mj.plants.kinds import KINDS
from dynabot_mj.study import assembly, campaign, checks, configuration, provenance, scenario
from dynabot_mj.study.campaign import Campaign, Entry
from dynabot_mj.study.execution import Execution, Results, ShareWatch, execute
from dynabot_mj.study.scenario import Case, Scenario

_HERE = Execution()  # in this process
_OTHERS = (
    "trials",
    "first_trial",
    "plants",
    "estimators",
    "perception",
)  # keys that tell which cases and trials there are
RECORDED = 1  # trajectories kept of each case, from the study's first trial on

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
    return whole(made, execute(chunks(made), execution, ShareWatch(progress)))


def whole(made: Campaign, results: Results) -> xr.Dataset:
    """Returns the Dataset of a campaign whose chunks are done, in memory."""
    buffer = io.BytesIO()
    write(made, results, buffer)
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
    expected = ("diverged", *(name for name in _VARIABLES if name not in _LATER), "error_lag")
    return [name for name in expected if name not in study.variables]


def _indexed(study: xr.Dataset) -> xr.Dataset:
    """Lets cases of a campaign be selected by what they differ in, as in `study.sel(robots=5)`."""
    if "grid" not in study.attrs:
        return study
    for name in [str(one) for one, array in study.coords.items() if array.dims == ("case",)]:
        if name not in study.xindexes:
            study = study.set_xindex(name)
    return study


@dataclass(frozen=True)
class TrialChunk:
    """Some trials of one case, a `execution.Chunk`."""

    setup: Scenario
    case: Case
    label: str
    trials: range
    recorded: int
    basis: Mapping[str, Any]  # what all outcomes of its case depend on

    @property
    def start(self) -> int:
        """Number of the first trial."""
        return self.trials.start

    @property
    def weight(self) -> float:
        """Rough seconds of work."""
        trial, robot = KINDS[self.case.plant].work
        per_trial = trial + robot * self.setup.robots
        events = 1e3 / scenario.periods(self.setup, self.case.estimator)[1]
        if self.case.perception == "filter":
            per_trial += 1e-5 * events * self.setup.robots
        return scenario.duration(self.setup) * (len(self.trials) * per_trial + events * 3e-4)

    @property
    def origin(self) -> Mapping[str, Any]:
        """What the outcome depends on."""
        return {**self.basis, "trials": [self.trials.start, self.trials.stop], "recorded": self.recorded}

    def run(self, threads: int, progress: Progress) -> Columns:
        """Runs the trials."""
        outcome = assembly.simulate(
            self.setup, self.case, self.trials, recorded=self.recorded, threads=threads, progress=progress
        )
        return records.flatten(outcome)


def chunks(made: Campaign) -> list[TrialChunk]:
    """Returns the work of a campaign: for each of its entries the trials in chunks of fixed size."""
    shared = [_basis(point.setup) for point in made.points]
    return [chunk for entry in made.entries for chunk in _chunks(made, entry, shared[entry.point])]


def _basis(setup: Scenario) -> dict[str, Any]:
    """Returns what outcomes depend on beside their case and trials: which others there are does not matter."""
    tree = tomllib.loads(configuration.dump(setup))
    return {
        "configuration": {key: value for key, value in tree.items() if key not in _OTHERS},
        "inputs": provenance.inputs(setup),
        "computation": provenance.computation(),
    }


def _chunks(made: Campaign, entry: Entry, shared: Mapping[str, Any]) -> Iterator[TrialChunk]:
    setup, basis = made.points[entry.point].setup, {**shared, "case": asdict(entry.case)}
    first, end, size = setup.first_trial, setup.first_trial + setup.trials, KINDS[entry.case.plant].chunk
    for start in range(first, end, size):
        yield TrialChunk(
            setup=setup,
            case=entry.case,
            label=entry.label,
            trials=range(start, min(start + size, end)),
            recorded=max(0, RECORDED - (start - first)),
            basis=basis,
        )


def write(made: Campaign, results: Results, target: Path | io.BytesIO) -> None:
    """Writes the Dataset of a campaign whose chunks are done.

    Args:
        made: The campaign.
        results: Of `chunks(made)`.
        target: Of the file, or of its bytes.

    Raises:
        OSError: If there is no room for it.
    """
    work, labels = chunks(made), [entry.label for entry in made.entries]
    first_of = {chunk.label: index for index, chunk in reversed(list(enumerate(work)))}
    heads = [results[first_of[label]] for label in labels]
    setups = [made.points[entry.point].setup for entry in made.entries]
    longest = max((head["time"] for head in heads), key=len)
    sizes = {
        "case": len(labels),
        "trial": made.first.trials,
        "recorded": min(RECORDED, made.first.trials),
        "time": len(longest),
        "lag": max(head["errors.lag"].shape[-1] for head in heads),
        "robot": max(setup.robots for setup in setups),
        "axis": 2,
    }
    told = {"units": "1", "long_name": "1: broke down"}
    variables = {"diverged": Variable(("case", *_TRIAL), told, np.int8)}
    for name, (_, dimensions, unit, meaning) in _VARIABLES.items():
        variables[name] = Variable(("case", *dimensions), {"units": unit, "long_name": meaning})
    per_case = _per_case(made, heads)
    variables |= {name: variable for name, (variable, _) in per_case.items()}
    attributes = _attributes(made)
    with netcdf.writing(target, sizes, _coordinates(made, longest), variables, attributes) as file:
        for name, (_, values) in per_case.items():
            file.put(name, ..., values)
        for index, chunk in enumerate(work):
            case, start = labels.index(chunk.label), chunk.trials.start - made.first.first_trial
            _put(file, case, start, heads[case] if index == first_of[chunk.label] else results[index])


def _put(file: netcdf.Writer, case: int, start: int, found: Columns) -> None:
    """Writes a chunk at its place."""
    diverged = found["diverged"]
    trials = slice(start, start + len(diverged))
    file.put("diverged", (case, trials), diverged.astype(np.int8))
    for name, (column, dimensions, _, _) in _VARIABLES.items():
        values = found[column].astype(float)
        if not len(values):
            continue  # no trajectory is kept of later chunks
        values[diverged[: len(values)]] = np.nan
        first = trials if dimensions[0] == "trial" else slice(0, len(values))
        # Shorter trials and smaller teams than the largest of a campaign fill their part; the rest stays NaN.
        file.put(name, (case, first, *(slice(0, size) for size in values.shape[1:])), values)


def _per_case(made: Campaign, heads: Sequence[Columns]) -> dict[str, tuple[Variable, Any]]:
    """Returns the variables that a case has, not each of its trials."""
    ticks, rows = [], []
    for entry in made.entries:
        setup = made.points[entry.point].setup
        rows.append(scenario.method(setup, entry.case.estimator))
        ticks.append([count * setup.processor.tick for count in scenario.periods(setup, entry.case.estimator)])
    periods, seconds = np.array(ticks), {"units": "s"}
    return {
        "error_lag": (
            Variable(("case", "lag"), {"units": "s", "long_name": "of the above"}),
            _padded([head["errors.lag"][0] for head in heads]),
        ),
        "sample_period": (Variable(("case",), seconds), periods[:, 0]),
        "control_period": (Variable(("case",), seconds), periods[:, 1]),
        "alpha_h": (Variable(("case",), {"units": "N m"}), [row.alpha_h for row in rows]),
        "alpha_d": (Variable(("case",), {"units": "N m"}), [row.alpha_d for row in rows]),
    }


def _padded(rows: Sequence[Array]) -> Array:
    found = np.full((len(rows), max(map(len, rows))), np.nan)
    for place, row in zip(found, rows, strict=True):
        place[: len(row)] = row
    return found


def _coordinates(made: Campaign, time: Any) -> dict[str, tuple[Sequence[str], Any, Mapping[str, Any]]]:
    setups = [made.points[entry.point].setup for entry in made.entries]
    cases = [entry.case for entry in made.entries]
    first, count = made.first.first_trial, made.first.trials
    found: dict[str, tuple[Sequence[str], Any, Mapping[str, Any]]] = {
        "case": (("case",), [entry.label for entry in made.entries], {}),
        "plant": (("case",), [case.plant for case in cases], {}),
        "perception": (("case",), [case.perception or "" for case in cases], {}),
        "estimator": (("case",), [case.estimator for case in cases], {}),
        "velocity": (
            ("case",),
            [scenario.velocity(setup, case) for setup, case in zip(setups, cases, strict=True)],
            {},
        ),
        "trial": (("trial",), np.arange(first, first + count), {}),
        "time": (("time",), time, {"units": "s"}),
        "axis": (("axis",), ["x", "y"], {}),
    }
    if made.grid:
        found["point"] = (("case",), [entry.point for entry in made.entries], {"long_name": "of the grid"})
        for key, name in made.names.items():
            values = [made.points[entry.point].values[key] for entry in made.entries]
            if not (all(_is_number(one) for one in values) or all(isinstance(one, str) for one in values)):
                values = [one if isinstance(one, str) else json.dumps(one) for one in values]
            found[name] = (("case",), values, {"long_name": key})
    return found


def _attributes(made: Campaign) -> dict[str, Any]:
    setup = made.first
    attributes = {
        "title": "Formation control under limited computation: point masses and rigid bodies",
        "configuration": configuration.dump(setup),
        "inputs": json.dumps(provenance.inputs(setup)),
        "controller": setup.controller,
        "versions": provenance.versions(),
        "seed": setup.seed,
        "duration": scenario.duration(setup),
    }
    if made.grid:
        attributes["grid"] = made.grid
        attributes["inputs"] = json.dumps([provenance.inputs(point.setup) for point in made.points])
    return attributes


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


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
