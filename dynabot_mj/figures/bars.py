"""What cases are compared by, as bars: Table III of the paper, and the measures of this project."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from dynabot_mj.common.intervals import Hazard, Mean, MeanInterval, Rate
from dynabot_mj.common.legend import (
    PERCEPTION_NAMES,
)
from dynabot_mj.experiments.formation import measures, summaries
from dynabot_mj.experiments.formation.case_rows import CaseRow
from dynabot_mj.experiments.formation.compare import Comparison
from dynabot_mj.figures.style import STYLE
from dynabot_mj.perception import methods
from dynabot_mj.plants.kinds import KINDS
from dynabot_mj.testbed import paper

_PERCEPTION_HATCH = {"": "", "gauss-markov": "", "filter": "...", "fitted": "xxx"}

_Bar = tuple[float, float, float]  # height, and the lengths of its whiskers below and above
_NOTHING: _Bar = (math.nan, math.nan, math.nan)  # draws nothing


def table_iii(comparison: Comparison) -> Figure:
    """Draws Table III as bars: the paper and what reproduces it, by the paper's own measures.

    Of point masses where the study has them: its collision is of centres, which bodies cannot bring that near.
    """
    rows = comparison.rows
    plant = min((row.plant for row in rows), key=[*KINDS].index)
    rows = [row for row in rows if row.plant == plant]

    told = measures.panels("table_iii")

    def published(estimator: str) -> list[_Bar]:
        row = paper.TABLE_III.get(estimator)
        return [_bar(one.published(row), one.scale) if row and one.published else _NOTHING for one, _ in told]

    trials, seed = comparison.study.sizes["trial"], comparison.study.attrs["seed"]
    return _bars(
        rows,
        [title for _, title in told],
        lambda row: [_bar(row.measured[one.name], one.scale) for one, _ in told],
        published,
        f"Table III of the paper, and {trials} trials of {KINDS[plant].label} here (seed {seed}); "
        "rates with 95 % Wilson intervals",
    )


def outcomes(comparison: Comparison) -> Figure:
    """Draws what cases are compared by: arrival, time to formation, contact, and formations within a common metre."""
    told = measures.panels("outcomes")
    trials, seed = comparison.study.sizes["trial"], comparison.study.attrs["seed"]
    horizon = f"{comparison.study.attrs['duration']:g} s"
    return _bars(
        comparison.rows,
        [title.format(horizon=horizon) for _, title in told],
        lambda row: [_bar(row.measured[one.name], one.scale) for one, _ in told],
        None,
        f"{trials} trials of {comparison.study.sizes['robot']} robots (seed {seed}); whiskers: 95 %, but for ± sd",
    )


def _bars(
    rows: Sequence[CaseRow],
    titles: Sequence[str],
    shown: Callable[[CaseRow], list[_Bar]],
    published: Callable[[str], list[_Bar]] | None,
    title: str,
) -> Figure:
    """Draws a panel for each measure and in it a group of bars for each method.

    Args:
        rows: Of the study.
        titles: Of the panels.
        shown: The bars of a row, one for each panel.
        published: The paper's, likewise; None: it has none.
        title: Of the figure.
    """
    estimators = list(dict.fromkeys(row.estimator for row in rows))
    most = max(sum(row.estimator == estimator for row in rows) for estimator in estimators)
    width = 0.78 / ((published is not None) + most)
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(1, len(titles), figsize=(3.3 * len(titles) + 1.1, 4.0), layout="constrained")
        for index, estimator in enumerate(estimators):
            colour = methods.colour(estimator)
            groups: list[tuple[list[_Bar], dict[str, Any]]] = []
            if published is not None:
                groups.append((published(estimator), {"facecolor": "white", "edgecolor": colour, "hatch": "////"}))
            groups += [(shown(row), _drawn(row, colour)) for row in rows if row.estimator == estimator]
            for bar, (values, drawn) in enumerate(groups):
                place = index + (bar - (len(groups) - 1) / 2.0) * (1.1 * width)
                for axis, (height, below, above) in zip(axes, values, strict=True):
                    axis.bar(place, height, width, **drawn)
                    reach = [[below], [above]]
                    axis.errorbar(place, height, reach, color="#222222", linewidth=1.0, capsize=6.0 * width)
        for axis, name in zip(axes, titles, strict=True):
            axis.set_title(name, fontsize=10.5)
            axis.set_xticks(range(len(estimators)), [methods.label(name).replace(" ", "\n") for name in estimators])
            axis.grid(axis="x", visible=False)
            axis.set_ylim(0.0, 105.0 if "%" in name else None)
            axis.set_xlim(-0.6, max(len(estimators), 2) - 0.4)
        legend = _legend(rows, published is not None)
        figure.legend(handles=legend, loc="outside lower center", ncols=min(len(legend), 6))
        figure.suptitle(title, fontsize=11)
    return figure


def _drawn(row: CaseRow, colour: str) -> dict[str, Any]:
    hatch = _PERCEPTION_HATCH[row.perception or ""]
    drawn = {"facecolor": colour, "alpha": KINDS[row.plant].opacity, "hatch": hatch, "edgecolor": "white"}
    return drawn if hatch else {**drawn, "edgecolor": "none"}


def _legend(rows: Sequence[CaseRow], published: bool) -> list[Patch]:
    perceptions = list(dict.fromkeys(row.perception for row in rows if row.perception))
    plants = dict.fromkeys(row.plant for row in rows)
    empty: dict[str, Any] = {"facecolor": "white", "edgecolor": "#444444"}
    label = f"paper, {paper.ROBOTS} robots, {paper.TRIALS_TABLE_III} trials"
    return [
        *([Patch(**empty, hatch="////", label=label)] if published else []),
        *(Patch(facecolor="#444444", alpha=KINDS[plant].opacity, label=KINDS[plant].label) for plant in plants),
        *(
            Patch(**empty, hatch=_PERCEPTION_HATCH[name], label=PERCEPTION_NAMES[name])
            for name in (perceptions if len(perceptions) > 1 else [])
        ),
    ]


def _bar(found: Mean | MeanInterval | Hazard | Rate | None, scale: float) -> _Bar:
    """Returns height and whisker lengths of a summary's bar."""
    return _whiskers(*(None if value is None else scale * value for value in summaries.span(found)))


def _whiskers(middle: float | None, low: float | None, high: float | None) -> _Bar:
    """Returns height and whisker lengths of a bar with an interval."""
    if middle is None:
        return _NOTHING
    if low is None or high is None:
        return middle, 0.0, 0.0
    return middle, max(0.0, middle - low), max(0.0, high - middle)
