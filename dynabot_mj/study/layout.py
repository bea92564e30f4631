"""How the outcomes of a campaign lie in its Dataset, and how that is written: chunk by chunk, in little memory."""

import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from dynabot_mj.common import netcdf
from dynabot_mj.common.arrays import Array
from dynabot_mj.common.columns import Columns
from dynabot_mj.common.netcdf import Variable
from dynabot_mj.formation.scorer import Scores
from dynabot_mj.study import configuration, provenance, scenario, trial_chunks
from dynabot_mj.study.campaign import Campaign
from dynabot_mj.study.chunk_folder import Results

# Of each outcome: where it is, its dimensions behind `case`, unit and meaning; scores state their own. All are NaN for
# trials that diverged.
_TRIAL = ("trial",)
_LAGS = ("trial", "lag")
VARIABLES = {
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
LATER = tuple(one.name for one in fields(Scores) if not one.metadata["always"])  # which older studies do not have


def write(made: Campaign, results: Results, target: Path | io.BytesIO) -> None:
    """Writes the Dataset of a campaign whose chunks are done.

    Args:
        made: The campaign.
        results: Of its `trial_chunks.chunks`.
        target: Of the file, or of its bytes.

    Raises:
        OSError: If there is no room for it.
    """
    work = trial_chunks.chunks(made)
    place = {entry.label: index for index, entry in enumerate(made.entries)}
    first_of = {chunk.label: index for index, chunk in reversed(list(enumerate(work)))}
    heads = [results[first_of[label]] for label in place]
    setups = [made.points[entry.point].setup for entry in made.entries]
    longest = max((head["time"] for head in heads), key=len)
    sizes = {
        "case": len(place),
        "trial": made.first.trials,
        "recorded": min(trial_chunks.RECORDED, made.first.trials),
        "time": len(longest),
        "lag": max(head["errors.lag"].shape[-1] for head in heads),
        "robot": max(setup.robots for setup in setups),
        "axis": 2,
    }
    told = {"units": "1", "long_name": "1: broke down"}
    variables = {"diverged": Variable(("case", *_TRIAL), told, np.int8)}
    for name, (_, dimensions, unit, meaning) in VARIABLES.items():
        variables[name] = Variable(("case", *dimensions), {"units": unit, "long_name": meaning})
    per_case = _per_case(made, heads)
    variables |= {name: variable for name, (variable, _) in per_case.items()}
    attributes = _attributes(made)
    with netcdf.writing(target, sizes, _coordinates(made, longest), variables, attributes) as file:
        for name, (_, values) in per_case.items():
            file.put(name, ..., values)
        for index, chunk in enumerate(work):
            case, start = place[chunk.label], chunk.start - made.first.first_trial
            _put(file, case, start, heads[case] if index == first_of[chunk.label] else results[index])


def _put(file: netcdf.Writer, case: int, start: int, found: Columns) -> None:
    """Writes a chunk at its place."""
    diverged = found["diverged"]
    trials = slice(start, start + len(diverged))
    file.put("diverged", (case, trials), diverged.astype(np.int8))
    for name, (column, dimensions, _, _) in VARIABLES.items():
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
