"""Figures of a study. One colour per robot and one per method, the same in every figure; colour-blind safe."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from dynabot_mj.common import intervals
from dynabot_mj.common.legend import (
    METHOD_COLOURS,
    METHOD_NAMES,
    PERCEPTION_COLOURS,
    PERCEPTION_NAMES,
    PLANT_NAMES,
    ROBOT_COLOURS,
)
from dynabot_mj.experiments.formation.case_rows import Row
from dynabot_mj.experiments.formation.compare import Comparison
from dynabot_mj.figures.style import STYLE
from dynabot_mj.study import configuration, scenario
from dynabot_mj.study.scenario import Scenario
from dynabot_mj.testbed import paper as testbed

_PLANT_ALPHA = {"particle": 0.45, "rigid": 1.0}
_PERCEPTION_HATCH = {"": "", "gauss-markov": "", "filter": "...", "fitted": "xxx"}

_Bar = tuple[float, float, float]  # height, and the lengths of its whiskers below and above
_NOTHING: _Bar = (math.nan, math.nan, math.nan)  # draws nothing


def trajectories(study: xr.Dataset, estimator: str, perception: str) -> Figure:
    """Draws Fig. 4 for one method: the first trial's paths, each plant in a column, whole and near the leader.

    Args:
        study: Dataset of a study.
        estimator: Name of the method.
        perception: Of the cases that are drawn; "" for perfect information.

    Returns:
        The figure; positions in metres.
    """
    setup = configuration.load(study.attrs["configuration"], "the study's configuration")
    cases = [study.isel(case=i) for i in range(study.sizes["case"])]
    cases = [case for case in cases if case.estimator == estimator and case.perception == perception]
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            2,
            len(cases),
            figsize=(4.6 * len(cases) + (1.6 if len(cases) == 1 else 0.0), 6.2),
            squeeze=False,
            height_ratios=(1.0, 2.6),
            layout="constrained",
        )
        for column, case in enumerate(cases):
            for axis in axes[:, column]:
                _draw_paths(axis, case)
                _draw_well(axis, setup, estimator)
            axes[0, column].set_title(PLANT_NAMES[str(case.plant.item())])
            # The same limits for both plants, so that the paths can be compared.
            edge = scenario.field(setup, "perfect").leader.radius + setup.field.width
            near = edge + 2.5
            paths = study.trajectory_w
            side = max(edge + 1.0, 1.0 + float(abs(paths.sel(axis="y")).max(skipna=True)))
            axes[0, column].set_xlim(float(paths.sel(axis="x").min()) - 2.0, edge + 2.0)
            axes[0, column].set_ylim(-side, side)
            axes[1, column].set_xlim(-near, near)
            axes[1, column].set_ylim(-near, near)
            for axis in axes[:, column]:
                axis.set_aspect("equal")
                axis.set_xlabel("x [m]")
                axis.set_ylabel("y [m]" if column == 0 else "")
        handles, labels = axes[1, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=9)
        figure.suptitle(_caption(study, setup, estimator, perception), fontsize=11)
    return figure


def table_iii(comparison: Comparison) -> Figure:
    """Draws Table III as bars: the paper and what reproduces it, by the paper's own measures.

    Of point masses where the study has them: its collision is of centres, which bodies cannot bring that near.
    """
    rows = comparison.rows
    plant = min(row.plant for row in rows)  # particle comes first
    rows = [row for row in rows if row.plant == plant]

    def shown(row: Row) -> list[_Bar]:
        settling = row.settling_s
        spread = settling.sd or 0.0
        return [
            (math.nan if settling.mean is None else settling.mean, spread, spread),
            _percent(row.collision),
            _percent(row.completion),
        ]

    def published(estimator: str) -> list[_Bar]:
        paper = testbed.TABLE_III[estimator]
        spread = paper.settling_sd or 0.0
        rates = (_percent(_published(share)) for share in (paper.collision, paper.completion))
        return [(paper.settling, spread, spread), *rates]

    trials, seed = comparison.study.sizes["trial"], comparison.study.attrs["seed"]
    return _bars(
        rows,
        ("settling time [s], mean ± sd", "collision of centres [%]", "completion, method's own σ [%]"),
        shown,
        published,
        f"Table III of the paper, and {trials} trials of {PLANT_NAMES[plant]} here (seed {seed}); "
        "rates with 95 % Wilson intervals",
    )


def outcomes(comparison: Comparison) -> Figure:
    """Draws what cases are compared by: arrival, time to formation, contact, and formations within a common metre."""

    def shown(row: Row) -> list[_Bar]:
        arrival, formation = row.arrival_s, row.time_to_formation_s
        spread = arrival.sd or 0.0
        return [
            (math.nan if arrival.mean is None else arrival.mean, spread, spread),
            _whiskers(formation.mean, formation.low, formation.high),
            _percent(row.collision_footprint),
            _percent(row.completion_common),
        ]

    trials, seed = comparison.study.sizes["trial"], comparison.study.attrs["seed"]
    horizon = comparison.study.attrs["duration"]
    return _bars(
        comparison.rows,
        (
            "arrival [s], mean ± sd",
            f"time to formation [s],\nmean restricted to {horizon:g} s",
            "trials in which hulls\noverlap [%]",
            "formation within 1 m,\nno contact [%]",
        ),
        shown,
        None,
        f"{trials} trials of {comparison.study.sizes['robot']} robots (seed {seed}); whiskers: 95 %, but for ± sd",
    )


def errors(study: xr.Dataset) -> Figure | None:
    """Draws how large the errors of the robots' positions are in the loop, and how long they last.

    Returns:
        A panel for each estimator; None where the study has no errors.
    """
    cases = [study.isel(case=index) for index in range(study.sizes["case"])]
    cases = [case for case in cases if float(case.position_autocovariance.isel(lag=0).mean()) > 0.0]
    if not cases:
        return None
    estimators = list(dict.fromkeys(str(case.estimator.item()) for case in cases))
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            1,
            len(estimators),
            figsize=(1.2 + 3.6 * len(estimators), 4.2),
            sharey=True,
            squeeze=False,
            layout="constrained",
        )
        for axis, estimator in zip(axes[0], estimators, strict=True):
            for case in (case for case in cases if case.estimator == estimator):
                perception, plant = str(case.perception.item()), str(case.plant.item())
                covariance = case.position_autocovariance.mean("trial").values
                axis.plot(
                    case.error_lag.values,
                    covariance / covariance[0],
                    "-" if plant == "rigid" else "--",
                    marker="o",
                    markersize=3.5,
                    fillstyle="full" if plant == "rigid" else "none",
                    color=PERCEPTION_COLOURS[perception],
                    label=f"{PERCEPTION_NAMES[perception]}, {PLANT_NAMES[plant]}: {math.sqrt(covariance[0]):.2f} m",
                )
            axis.set_xscale("symlog", linthresh=0.05, linscale=0.3)
            axis.set_xlim(0.0, 40.0)
            axis.set_xticks([0.0, 0.1, 1.0, 10.0], ["0", "0.1", "1", "10"])
            axis.axhline(0.0, color="#888888", linewidth=0.8)
            axis.set_title(METHOD_NAMES[estimator])
            axis.set_xlabel("lag [s]")
            axis.legend(fontsize=7.5, loc="upper center", bbox_to_anchor=(0.5, -0.16), handlelength=3.5)
        axes[0, 0].set_ylabel("autocorrelation of the position error")
        trials, seed = study.sizes["trial"], study.attrs["seed"]
        figure.suptitle(
            f"What robots believe of their position in the loop, and its root mean square per axis; {trials} trials, "
            f"seed {seed}",
            fontsize=11,
        )
    return figure


def _draw_paths(axis: Axes, case: xr.Dataset) -> None:
    path = case.trajectory_w.isel(recorded=0)
    for robot in range(path.sizes["robot"]):
        x, y = (path.isel(robot=robot).sel(axis=name) for name in ("x", "y"))
        colour = ROBOT_COLOURS[robot]
        axis.plot(x, y, color=colour, linewidth=1.3, label=f"robot {robot + 1}")
        axis.plot(x[0], y[0], "o", color=colour, markersize=4, fillstyle="none")
        axis.plot(x[-1], y[-1], "o", color=colour, markersize=6)


def _draw_well(axis: Axes, setup: Scenario, estimator: str) -> None:
    well = scenario.field(setup, estimator).leader  # type: ignore[arg-type]
    rings = (
        (well.radius, "-", "floor h0"),
        (well.radius + well.width, "--", "floor h0 + ε"),
        (well.radius - well.width / 2.0, ":", "paper's Fig. 4, h0 ± ε/2"),
        (well.radius + well.width / 2.0, ":", None),
    )
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    for radius, style, label in rings:
        colour = "#999999" if style == ":" else "#444444"
        axis.plot(radius * np.cos(angle), radius * np.sin(angle), style, color=colour, linewidth=1.1, label=label)
    axis.plot(0.0, 0.0, "D", color="#222222", markersize=6, linestyle="none", label="leader")


def _caption(study: xr.Dataset, setup: Scenario, estimator: str, perception: str) -> str:
    period = float(study.control_period[list(study.estimator.values).index(estimator)])
    name = METHOD_NAMES[estimator]
    if perception:
        name += f", {PERCEPTION_NAMES[perception]}"
    return f"{name}, T_c = {1e3 * period:g} ms, trial {setup.first_trial} of seed {setup.seed}"


def _bars(
    rows: Sequence[Row],
    titles: Sequence[str],
    shown: Callable[[Row], list[_Bar]],
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
            colour = METHOD_COLOURS[estimator]
            groups: list[tuple[list[_Bar], dict[str, Any]]] = []
            if published is not None:
                groups.append((published(estimator), {"facecolor": "white", "edgecolor": colour, "hatch": "////"}))
            groups += [(shown(row), _look(row, colour)) for row in rows if row.estimator == estimator]
            for bar, (values, look) in enumerate(groups):
                place = index + (bar - (len(groups) - 1) / 2.0) * (1.1 * width)
                for axis, (height, below, above) in zip(axes, values, strict=True):
                    axis.bar(place, height, width, **look)
                    reach = [[below], [above]]
                    axis.errorbar(place, height, reach, color="#222222", linewidth=1.0, capsize=6.0 * width)
        for axis, name in zip(axes, titles, strict=True):
            axis.set_title(name, fontsize=10.5)
            axis.set_xticks(range(len(estimators)), [METHOD_NAMES[name].replace(" ", "\n") for name in estimators])
            axis.grid(axis="x", visible=False)
            axis.set_ylim(0.0, 105.0 if "%" in name else None)
            axis.set_xlim(-0.6, max(len(estimators), 2) - 0.4)
        legend = _legend(rows, published is not None)
        figure.legend(handles=legend, loc="outside lower center", ncols=min(len(legend), 6))
        figure.suptitle(title, fontsize=11)
    return figure


def _look(row: Row, colour: str) -> dict[str, Any]:
    hatch = _PERCEPTION_HATCH[row.perception or ""]
    look = {"facecolor": colour, "alpha": _PLANT_ALPHA[row.plant], "hatch": hatch, "edgecolor": "white"}
    return look if hatch else {**look, "edgecolor": "none"}


def _legend(rows: Sequence[Row], paper: bool) -> list[Patch]:
    perceptions = list(dict.fromkeys(row.perception for row in rows if row.perception))
    plants = dict.fromkeys(row.plant for row in rows)
    empty: dict[str, Any] = {"facecolor": "white", "edgecolor": "#444444"}
    label = f"paper, {testbed.ROBOTS} robots, {testbed.TRIALS_TABLE_III} trials"
    return [
        *([Patch(**empty, hatch="////", label=label)] if paper else []),
        *(Patch(facecolor="#444444", alpha=_PLANT_ALPHA[plant], label=PLANT_NAMES[plant]) for plant in plants),
        *(
            Patch(**empty, hatch=_PERCEPTION_HATCH[name], label=PERCEPTION_NAMES[name])
            for name in (perceptions if len(perceptions) > 1 else [])
        ),
    ]


def _published(share: float) -> intervals.Rate:
    """Returns a rate of Table III with the interval that its number of trials gives."""
    return intervals.share(round(share * testbed.TRIALS_TABLE_III), testbed.TRIALS_TABLE_III)


def _percent(rate: intervals.Rate | None) -> _Bar:
    """Returns height and whisker lengths of a rate's bar [%]."""
    if rate is None:
        return _NOTHING
    return _whiskers(*(None if value is None else 100.0 * value for value in (rate.rate, rate.low, rate.high)))


def _whiskers(middle: float | None, low: float | None, high: float | None) -> _Bar:
    """Returns height and whisker lengths of a bar with an interval."""
    if middle is None:
        return _NOTHING
    if low is None or high is None:
        return middle, 0.0, 0.0
    return middle, max(0.0, middle - low), max(0.0, high - middle)
