"""The figure of `dynabot study`: measures over one or two factors of a grid."""

from collections.abc import Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dynabot_mj.common.intervals import Mean
from dynabot_mj.experiments.formation import grid as experiment
from dynabot_mj.experiments.formation.grid import Grid, GridRow
from dynabot_mj.figures.style import STYLE
from dynabot_mj.perception import methods
from dynabot_mj.plants.kinds import KINDS

_MARKERS = "osD^vPX"
_LEVEL_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")


def grid(found: Grid) -> Figure:
    """Draws a row of panels for each measure and a column for each value of the second factor, a line for each case."""
    first, *second = found.over
    across = experiment.levels(found, second[0]) if second else [None]
    places, ticks = _places(experiment.levels(found, first))
    names = list(dict.fromkeys(experiment.case_name(row, found) for row in found.rows))
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            len(found.shown),
            len(across),
            figsize=(1.4 + 3.4 * len(across), 1.2 + 2.9 * len(found.shown)),
            sharex=True,
            sharey="row",
            squeeze=False,
            layout="constrained",
        )
        for column, value in enumerate(across if second else []):
            axes[0, column].set_title(f"{second[0]} {_text(value)}", fontsize=10)
        for line, name in zip(axes, found.shown, strict=True):
            measure = experiment.measure(name)
            for axis, value in zip(line, across, strict=True):
                for index, case in enumerate(names):
                    rows = [
                        row
                        for row in found.rows
                        if experiment.case_name(row, found) == case and (not second or row.at(second[0]) == value)
                    ]
                    x = [places[str(row.at(first))] + 0.012 * (index - (len(names) - 1) / 2.0) for row in rows]
                    _draw(axis, x, [_interval(row, name, measure.scale) for row in rows], case, _look(rows, index))
            line[0].set_ylabel(experiment.title(measure))
            line[0].set_ylim(0.0, 1.06 * line[0].get_ylim()[1])
        for axis in axes[-1]:
            axis.set_xlabel(first)
            axis.set_xticks(*ticks)
            axis.margins(x=0.08)
        handles, labels = axes[0, 0].get_legend_handles_labels()
        if any(labels):
            figure.legend(handles, labels, loc="outside lower center", ncols=min(len(names), 4))
        figure.suptitle(f"{found.trials} trials of each case, seed {found.seed}; 95 %, but ± sd of means", fontsize=11)
    return figure


def _draw(axis: Axes, x: Sequence[float], told: Sequence[Any], case: str, look: dict[str, Any]) -> None:
    known = [(place, one) for place, one in zip(x, told, strict=True) if one[0] is not None]
    if not known:
        return
    middle = [one[0] for _, one in known]
    axis.plot([place for place, _ in known], middle, markersize=4.5, linewidth=1.3, label=case, **look)
    for place, (_, low, high) in known:
        if low is not None and high is not None:
            axis.plot([place, place], [low, high], color=look["color"], linewidth=1.3)


def _look(rows: Sequence[GridRow], index: int) -> dict[str, Any]:
    """Returns how a case looks: methods and plants as everywhere, where they are what differs."""
    row = rows[0] if rows else None
    return {
        "color": methods.colour(row.row.estimator) if row else _LEVEL_COLOURS[index % len(_LEVEL_COLOURS)],
        "linestyle": KINDS[row.row.plant].line if row else "-",
        "marker": _MARKERS[index % len(_MARKERS)],
    }


def _places(levels: Sequence[Any]) -> tuple[dict[str, float], tuple[list[float], list[str]]]:
    """Returns where the values of a factor are on the axis: numbers to scale, all else side by side."""
    numbers = all(isinstance(one, int | float) for one in levels) and len(levels) > 1
    span = (max(levels) - min(levels)) or 1.0 if numbers else 1.0
    least = min(levels) if numbers else 0.0
    at = [(one - least) / span if numbers else index / max(len(levels) - 1, 1) for index, one in enumerate(levels)]
    return dict(zip(map(str, levels), at, strict=True)), (at, [_text(one) for one in levels])


def _interval(row: GridRow, name: str, scale: float) -> tuple[float | None, float | None, float | None]:
    found = row.row.measured[name]
    if found is None:
        return None, None, None
    middle = getattr(found, "mean", None) if hasattr(found, "mean") else found.rate
    if isinstance(found, Mean):
        spread = found.sd
        low, high = (None, None) if middle is None or spread is None else (middle - spread, middle + spread)
    else:
        low, high = found.low, found.high
    return tuple(None if one is None or not np.isfinite(one) else scale * one for one in (middle, low, high))  # type: ignore[return-value]


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
