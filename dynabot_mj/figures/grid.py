"""The figure of `dynabot study`: measures over one or two factors of a grid."""

from collections.abc import Sequence
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dynabot_mj.common.intervals import Mean
from dynabot_mj.experiments.formation import grid as experiment
from dynabot_mj.experiments.formation import summaries
from dynabot_mj.experiments.formation.grid import Grid
from dynabot_mj.figures.style import STYLE
from dynabot_mj.perception import methods
from dynabot_mj.plants.kinds import KINDS

_MARKERS = "osD^vPX"
_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
_LEGEND_ENTRY, _LEGEND_LETTER = 0.75, 0.085  # widths of an entry without its name, and of a letter [inches]


def grid(found: Grid) -> Figure:
    """Draws a row of panels for each measure and a column for each value of the second factor, a line for each case."""
    first, *second = found.over
    across = experiment.levels(found, second[0]) if second else [None]
    places, ticks = _places(experiment.levels(found, first))
    names = list(dict.fromkeys(experiment.case_name(row, found) for row in found.rows))
    looks = _looks(found, names)
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
            axes[0, column].set_title(f"{second[0]} {experiment.text(value)}", fontsize=10)
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
                    _draw(axis, x, [_scaled(row.row.measured[name], measure.scale) for row in rows], case, looks[case])
            line[0].set_ylabel(experiment.title(measure))
            top = 1.06 * line[0].get_ylim()[1]
            line[0].set_ylim(-0.03 * top, top)  # markers at zero are whole
        for axis in axes[-1]:
            axis.set_xlabel(first)
            axis.set_xticks(*ticks)
            margin = 0.08 if _numbers(experiment.levels(found, first)) else 0.2  # words are wide
            axis.set_xlim(-margin, max(places.values()) + margin)
        handles = {
            label: handle for axis in axes.flat for handle, label in zip(*axis.get_legend_handles_labels(), strict=True)
        }
        if order := [name for name in names if name in handles]:
            columns = _legend_columns(order, figure.get_figwidth())
            figure.legend([handles[name] for name in order], order, loc="outside lower center", ncols=columns)
        figure.suptitle(f"{found.trials} trials of each case, seed {found.seed}\n{_bars(found)}", fontsize=10)
    return figure


def _legend_columns(names: Sequence[str], width: float) -> int:
    """Returns how many columns of a legend a figure of some width [inches] holds."""
    return max(1, min(len(names), 4, int(width / (_LEGEND_ENTRY + _LEGEND_LETTER * max(map(len, names))))))


def _bars(found: Grid) -> str:
    """Says what the bars are."""
    means = [name for name in found.shown if any(isinstance(row.row.measured[name], Mean) for row in found.rows)]
    told = ", ".join(experiment.title(experiment.measure(name)).partition(" [")[0] for name in means)
    if len(means) == len(found.shown):
        return "bars: ± sd"
    return f"bars: 95 % intervals{f', of {told} ± sd' if told else ''}"


def _draw(axis: Axes, x: Sequence[float], told: Sequence[Any], case: str, look: dict[str, Any]) -> None:
    known = [(place, one) for place, one in zip(x, told, strict=True) if one[0] is not None]
    if not known:
        return
    middle = [one[0] for _, one in known]
    axis.plot([place for place, _ in known], middle, markersize=4.5, linewidth=1.3, label=case, **look)
    for place, (_, low, high) in known:
        if low is not None and high is not None:
            axis.plot([place, place], [low, high], color=look["color"], linewidth=1.3)


def _looks(found: Grid, names: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Returns how cases look: methods and plants as everywhere; what else tells them apart are markers, then hollow."""
    looks: dict[str, dict[str, Any]] = {}
    for index, name in enumerate(names):
        row = next(row.row for row in found.rows if experiment.case_name(row, found) == name)
        many = "estimator" in found.over  # a line or the panels are of all of them
        colour = _COLOURS[index % len(_COLOURS)] if many else methods.colour(row.estimator)
        look = {"color": colour, "linestyle": "-" if "plant" in found.over else KINDS[row.plant].line}
        twin = any(look.items() <= other.items() for other in looks.values())
        hollow = {"markerfacecolor": "white"} if twin else {}
        looks[name] = {**look, "marker": _MARKERS[index % len(_MARKERS)], **hollow}
    return looks


def _places(levels: Sequence[Any]) -> tuple[dict[str, float], tuple[list[float], list[str]]]:
    """Returns where the values of a factor are on the axis: numbers to scale, all else side by side."""
    numbers = _numbers(levels)
    span = (max(levels) - min(levels)) or 1.0 if numbers else 1.0
    least = min(levels) if numbers else 0.0
    at = [(one - least) / span if numbers else index / max(len(levels) - 1, 1) for index, one in enumerate(levels)]
    return dict(zip(map(str, levels), at, strict=True)), (at, [experiment.text(one) for one in levels])


def _numbers(levels: Sequence[Any]) -> bool:
    return all(isinstance(one, int | float) for one in levels) and len(levels) > 1


def _scaled(found: Any, scale: float) -> list[float | None]:
    """Returns the value of a summary, and where it is from and to."""
    return [None if one is None else scale * one for one in summaries.span(found)]
