"""A campaign as readable tables: all cases, measures over one or two factors, and differences on the same trials."""

from dataclasses import replace
from typing import Any

from dynabot_mj.common import intervals, tables
from dynabot_mj.common.tables import Table
from dynabot_mj.experiments.formation import compare_tables, measures
from dynabot_mj.experiments.formation.grid import Grid, GridRow, case_name, levels, measure, text, title, varying
from dynabot_mj.experiments.formation.measure import FACTORS
from dynabot_mj.experiments.formation.measures import TESTED


def markdown(grid: Grid) -> str:
    """Returns the tables: all cases, each measure that is shown over its factors, and the differences."""
    made = [_all(grid), *(_pivot(grid, name) for name in grid.shown)]
    if grid.paired:
        made.append(_differences(grid))
    return "\n\n".join(one.markdown(level=1 if index == 0 else 2) for index, one in enumerate(made)) + "\n"


def _all(grid: Grid) -> Table:
    shown = measures.columns("cases")
    header = [*grid.factors, *FACTORS, *(column.header for _, column in shown), "overturned, diverged"]
    body = [
        [
            *(text(one.values[name]) for name in grid.factors),
            *(str(one.at(name) or "") for name in FACTORS),
            *(column.text(one.row.measured[measure.name]) for measure, column in shown),
            f"{'-' if one.row.overturned is None else one.row.overturned}, {one.row.diverged}",
        ]
        for one in grid.rows
    ]
    notes = dict.fromkeys(measure.note for measure, _ in shown if measure.note)
    horizon = " or ".join(f"{end:g} s" for end in grid.horizons)
    note = " ".join(notes).format(horizon=horizon if len(grid.horizons) < 4 else "the duration")
    return Table(
        title=f"{len(grid.rows)} cases of {grid.trials} trials, seed {grid.seed}", header=header, body=body, note=note
    )


def _pivot(grid: Grid, name: str) -> Table:
    """Returns a measure over one or two factors: cases and the first factor down, the second across."""
    first, *second = grid.over
    one = measure(name)
    column = one.columns[0] if one.columns else None
    cell = column.text if column else _plain
    across = levels(grid, second[0]) if second else [None]
    body = []
    for case in dict.fromkeys(case_name(row, grid) for row in grid.rows):
        for level in levels(grid, first):
            here = [row for row in grid.rows if case_name(row, grid) == case and row.at(first) == level]
            cells = []
            for value in across:
                match = [row for row in here if not second or row.at(second[0]) == value]
                cells.append(cell(match[0].row.measured[name]) if match else "")
            if any(cells):
                body.append([case, text(level), *cells])
    header = ["", first, *([f"{second[0]} {text(value)}" for value in across] if second else [title(one)])]
    return Table(title=f"{title(one)} over {' and '.join(grid.over)}", header=header, body=body)


def _differences(grid: Grid) -> Table:
    names = list(dict.fromkeys(one.metric for one in grid.paired))
    by_label = {one.label: one for one in grid.rows}
    shown = {one.name: one for one in TESTED}
    body = []
    for pair in dict.fromkeys((one.a, one.b) for one in grid.paired):
        of_pair = {one.metric: one for one in grid.paired if (one.a, one.b) == pair}
        cells = []
        for name in names:
            one, told = of_pair.get(name), shown[name]
            if one is None or one.difference is None:
                cells.append("-")
                continue
            difference, low, high = (_scaled(value, told.scale) for value in (one.difference, one.low, one.high))
            scaled = replace(one, difference=difference, low=low, high=high)
            holds = one.p_holm is not None and one.p_holm < compare_tables.ALPHA
            cells.append(tables.difference(scaled, told.digits) + (" *" if holds else ""))
        body.append([*_told(by_label[pair[0]], by_label[pair[1]], grid), *cells])
    return Table(
        title="Differences on the same trials",
        header=["of", "difference", *(shown[name].title for name in names)],
        body=body,
        note="With 95 % intervals; * below 0.05 after Holm's adjustment over all differences of one factor. Measures "
        "that the duration cuts off are not compared where durations differ.",
    )


def _told(one: GridRow, other: GridRow, grid: Grid) -> tuple[str, str]:
    """Returns what two cases share of what varies, and what they differ in."""
    shared, differ = [], []
    for name in varying(grid):
        a, b = one.at(name), other.at(name)
        if a != b:
            differ.append(f"{name} {text(a)} - {text(b)}")
        elif a is not None:
            shared.append(str(a) if name in FACTORS else f"{name} {text(a)}")
    return ", ".join(shared), ", ".join(differ)


def _plain(found: Any) -> str:
    return tables.rate(found) if isinstance(found, intervals.Rate) else tables.mean_and_sd(found)


def _scaled(value: float | None, scale: float) -> float | None:
    return None if value is None else scale * value
