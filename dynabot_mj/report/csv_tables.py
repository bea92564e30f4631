"""The tables of a study as CSV: one value in a cell, units in the names, nothing where nothing is known."""

import csv
import io
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any

import xarray as xr

from dynabot_mj.experiments.estimators import circle_report
from dynabot_mj.experiments.estimators.circle import CircleOutcome
from dynabot_mj.experiments.formation import case_rows
from dynabot_mj.experiments.formation.compare import Comparison


def of_study(comparison: Comparison) -> dict[str, str]:
    """Returns a study's tables by file name: its cases with their errors, differences, and trials one by one."""
    differences = [asdict(one) for one in comparison.paired]
    return {
        "cases.csv": _text([case_rows.document(one) for one in comparison.rows]),
        **({"differences.csv": _text(differences)} if differences else {}),
        "trials.csv": _text(list(_trials(comparison.study))),
    }


def of_circle(outcome: CircleOutcome) -> dict[str, str]:
    """Returns the table of the tether experiment by file name."""
    return {"circle.csv": _text([asdict(one) for one in circle_report.rows(outcome)])}


def _trials(study: xr.Dataset) -> Iterator[dict[str, Any]]:
    """Yields what each trial of each case was judged by, with the unit in the name."""
    names = [name for name in study.data_vars if study[name].dims == ("case", "trial")]
    for case in study.case.values:
        values = {name: study[name].sel(case=case).values for name in names}
        for index, trial in enumerate(study.trial.values):
            scores = {_with_unit(study[name]): float(column[index]) for name, column in values.items()}
            yield {"case": str(case), "trial": int(trial), **scores}


def _with_unit(variable: xr.DataArray) -> str:
    unit = variable.attrs["units"]
    return str(variable.name) if unit == "1" else f"{variable.name} [{unit}]"


def _text(rows: Sequence[Mapping[str, Any]]) -> str:
    flat = [dict(_flattened(row)) for row in rows]
    file = io.StringIO()
    keys = list(dict.fromkeys(key for row in flat for key in row))
    # A table inside a row that some rows lack has columns of its own already.
    columns = [key for key in keys if not any(other.startswith(f"{key}.") for other in keys)]
    writer = csv.DictWriter(file, columns, extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows(flat)
    return file.getvalue()


def _flattened(row: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yields a row's values; those of tables inside it with both names, lists as JSON, NaN as nothing."""
    for key, value in row.items():
        if isinstance(value, Mapping):
            yield from _flattened(value, f"{prefix}{key}.")
        elif isinstance(value, list | tuple):
            yield f"{prefix}{key}", json.dumps(value)
        else:
            yield f"{prefix}{key}", None if value != value else value  # only NaN differs from itself
