"""Campaigns: the cases of a grid by every measure, over one or two factors, and compared on the same trials.

A factor is a key of the grid or what cases of one configuration differ in: plant, perception, estimator.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import xarray as xr

from dynabot_mj.common import intervals
from dynabot_mj.common.exceptions import InputError, suggestion
from dynabot_mj.experiments.formation import case_rows, paired_tests
from dynabot_mj.experiments.formation.case_rows import CaseRow
from dynabot_mj.experiments.formation.measure import FACTORS, Measure
from dynabot_mj.experiments.formation.measures import MEASURES
from dynabot_mj.experiments.formation.paired_tests import Paired
from dynabot_mj.study import dataset
from dynabot_mj.study.campaign import Campaign

SHOWN = ("time_to_formation_s", "completion_common")  # unless others are asked for


@dataclass(frozen=True, kw_only=True)
class GridRow:
    """A case of a grid."""

    label: str
    values: Mapping[str, Any]  # of the grid's keys, by their names in the Dataset
    row: CaseRow

    def at(self, factor: str) -> Any:
        """Returns the value of a factor."""
        return self.values[factor] if factor in self.values else getattr(self.row, factor)


@dataclass(frozen=True, kw_only=True)
class Grid:
    """What a campaign says."""

    trials: int
    seed: int
    horizons: Sequence[float]  # how long trials are at the points [s]
    factors: Sequence[str]  # the grid's, by their names in the Dataset
    over: Sequence[str]  # one or two factors that tables and figures show the measures over
    shown: Sequence[str]  # names of measures
    rows: Sequence[GridRow]
    paired: Sequence[Paired]


def found(
    study: xr.Dataset,
    made: Campaign,
    over: Sequence[str] | None = None,
    shown: Sequence[str] = SHOWN,
    pairs: Sequence[tuple[str, str]] = (),
) -> Grid:
    """Summarises a campaign and compares its cases.

    Args:
        study: Its Dataset.
        made: The campaign.
        over: One or two factors to show measures over; None: the grid's first two, or the estimators.
        shown: Names of measures.
        pairs: Labels of cases to compare; none: those that differ in one key of the grid, with its first value.

    Raises:
        InputError: If there is no such factor, measure or case.
    """
    chosen = check(made, over, shown, pairs)
    keys = list(made.names.values())
    parts, labels, rows = dataset.points(study), iter(study.case.values), []
    for point, part in zip(made.points, parts, strict=True):
        values = {made.names[key]: value for key, value in point.values.items()}
        rows += [GridRow(label=str(next(labels)), values=values, row=row) for row in case_rows.rows(part)]
    cases = _cases(study, parts)
    wanted = pairs or list(_neighbours(rows, keys))
    return Grid(
        trials=study.sizes["trial"],
        seed=int(study.attrs["seed"]),
        horizons=list(dict.fromkeys(float(part.attrs["duration"]) for part in parts)),
        factors=keys,
        over=chosen,
        shown=shown,
        rows=rows,
        paired=_compared(cases, rows, wanted),
    )


def check(
    made: Campaign, over: Sequence[str] | None, shown: Sequence[str], pairs: Sequence[tuple[str, str]]
) -> list[str]:
    """Returns the factors to show measures over.

    Raises:
        InputError: If there is no such factor, measure or case; see `found`.
    """
    keys = list(made.names.values())
    varying = [name for name in FACTORS if len({getattr(one.case, name) for one in made.entries}) > 1]
    factors = [*keys, *FACTORS]
    chosen = list(over) if over else ([*keys, *varying][:2] or ["estimator"])
    for name in chosen:
        if name not in factors:
            raise InputError(f"--over {name} given, it must be one of {', '.join(factors)}{suggestion(name, factors)}")
    if len(chosen) > 2 or len(set(chosen)) < len(chosen):
        raise InputError(f"--over {' '.join(chosen)} given, it must be one factor or two")
    names = [one.name for one in MEASURES]
    for name in shown:
        if name not in names:
            raise InputError(f"--measures {name} given, it must be of {', '.join(names)}{suggestion(name, names)}")
    labels = [entry.label for entry in made.entries]
    for a, b in pairs:
        for label in (a, b):
            if label not in labels:
                raise InputError(f"--pair {label} given, the study has: {', '.join(labels)}{suggestion(label, labels)}")
        if a == b:
            raise InputError(f"--pair {a} {b} given, they must be two cases")
    return chosen


def document(grid: Grid) -> dict[str, Any]:
    """Returns the JSON document."""
    return {
        "factors": list(grid.factors),
        "rows": [{"case": one.label, "values": dict(one.values), **case_rows.document(one.row)} for one in grid.rows],
        "paired": [asdict(one) for one in grid.paired],
    }


def measure(name: str) -> Measure[Any]:
    """Returns a measure by its name."""
    return next(one for one in MEASURES if one.name == name)


def title(one: Measure[Any]) -> str:
    """Returns what a measure is called, with its unit."""
    name = one.columns[0].header if one.columns else one.name
    return f"{name} [%]" if one.scale == 100.0 and "[" not in name else name


def varying(grid: Grid) -> list[str]:
    """Returns the factors in which cases differ, the configuration's own before the grid's."""
    names = ("plant", "perception", "estimator", *grid.factors)
    return [name for name in names if len({str(one.at(name)) for one in grid.rows}) > 1]


def case_name(one: GridRow, grid: Grid) -> str:
    """Returns what tells a case from others at the same values of the factors that are shown."""
    names = [name for name in varying(grid) if name not in grid.over]
    told = (str(one.at(name)) if name in FACTORS else f"{name} {text(one.at(name))}" for name in names)
    return ", ".join(part for part in told if part and part != "None")


def levels(grid: Grid, factor: str) -> list[Any]:
    """Returns the values of a factor, in the grid's order."""
    found: list[Any] = []
    for one in grid.rows:
        if one.at(factor) not in found:
            found.append(one.at(factor))
    return found


def _cases(study: xr.Dataset, parts: Sequence[xr.Dataset]) -> dict[str, xr.Dataset]:
    labels = iter(study.case.values)
    return {str(next(labels)): part.isel(case=index) for part in parts for index in range(part.sizes["case"])}


def _neighbours(rows: Sequence[GridRow], keys: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Yields for each case the one at the first value of each key of the grid that differs from it in that alone."""
    for key in keys:
        first = rows[0].values[key]
        for one in rows:
            if one.values[key] == first:
                continue
            for other in rows:
                if other.values[key] == first and all(
                    one.at(name) == other.at(name) for name in (*keys, *FACTORS) if name != key
                ):
                    yield one.label, other.label


def _compared(
    cases: Mapping[str, xr.Dataset], rows: Sequence[GridRow], pairs: Sequence[tuple[str, str]]
) -> list[Paired]:
    """Compares pairs of cases; those that differ in one factor are one family, and all others are another."""
    by_label = {one.label: one for one in rows}
    families: dict[str, list[Paired]] = {}
    for a, b in pairs:
        one, other = by_label[a], by_label[b]
        differ = [name for name in (*one.values, *FACTORS) if one.at(name) != other.at(name)]
        factor = differ[0] if len(differ) == 1 else "several"
        families.setdefault(factor, []).extend(paired_tests.two_cases(cases[a], cases[b], a, b, factor))
    return [
        replace(one, p_holm=p)
        for family in families.values()
        for one, p in zip(family, intervals.holm([one.p for one in family]), strict=True)
    ]


def text(value: Any) -> str:
    """Returns a value of a factor."""
    return f"{value:g}" if isinstance(value, float) else str(value)
