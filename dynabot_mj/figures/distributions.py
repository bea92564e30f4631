"""Figures of all trials of a study: distributions, and what the body changes trial by trial."""

import math
from collections.abc import Callable
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dynabot_mj.common import legend
from dynabot_mj.common.arrays import Array
from dynabot_mj.common.legend import PERCEPTION_COLOURS
from dynabot_mj.experiments.formation import paired_tests, trial_values
from dynabot_mj.experiments.formation.compare import Comparison
from dynabot_mj.experiments.formation.measures import PAIRED
from dynabot_mj.experiments.formation.paired_tests import Paired
from dynabot_mj.figures.style import STYLE
from dynabot_mj.perception import methods
from dynabot_mj.plants.kinds import KINDS
from dynabot_mj.study import configuration


def incidence(study: xr.Dataset) -> Figure | None:
    """Draws formation and contact as competing outcomes: what share of the trials has met which of them first, by when.

    Formations grow from below, contacts and overturned bodies from above; what is between has met neither.

    Returns:
        A panel for each estimator; None for an older study, which does not tell.
    """
    if "formation" not in study.variables:
        return None
    end = float(study.attrs["duration"])

    def draw(axis: Axes, case: xr.Dataset, **look: Any) -> str:
        known = case.diverged.values == 0
        failed = trial_values.failure(case)[known]
        formed = trial_values.restricted(case, "formation")[known]
        # What fails after it has formed has met the formation first.
        first = np.where(formed < end, np.inf, failed)
        _steps(axis, first[np.isfinite(first)], int(known.sum()), end, upside_down=True, **look)
        _steps(axis, formed[formed < end], int(known.sum()), end, **look)
        return f"{(formed < end).sum()} form, {np.isfinite(first).sum()} touch first"

    figure = _panels(study, draw, "time [s]", "share of trials")
    figure.axes[0].set_xlim(0.0, end)
    return figure


def closest(study: xr.Dataset) -> Figure:
    """Draws how near two robots' centres came in a trial, and the distance that counts as a collision."""
    collision = configuration.load(study.attrs["configuration"], "the study's configuration").collision_distance
    values = study.closest.values[np.isfinite(study.closest.values)]
    edge = 1.05 * max(float(values.max()), collision) if len(values) else 2.0 * collision

    def draw(axis: Axes, case: xr.Dataset, **look: Any) -> str:
        distances = case.closest.values[np.isfinite(case.closest.values)]
        _steps(axis, distances, len(distances), edge, **look)
        return f"{(distances < collision).sum()} of {len(distances)} collide"

    figure = _panels(study, draw, "smallest distance of two centres [m]", "share of trials")
    for axis in figure.axes:
        axis.axvspan(0.0, collision, color="#000000", alpha=0.07, linewidth=0.0)
    figure.axes[0].set_xlim(0.0, edge)
    return figure


def differences(comparison: Comparison) -> Figure | None:
    """Draws the mean paired differences particle minus rigid body with their 95 % intervals.

    Returns:
        A panel for each metric; None where the study has one plant only.
    """
    pairs = paired_tests.of_factor(comparison.paired, "plant")
    if not pairs:
        return None
    cases = list(dict.fromkeys(one.a.split("/", 1)[1] for one in pairs))
    several = len({case.split("/")[0] for case in cases if "/" in case}) > 1
    told = [one for one in PAIRED if "differences" in one.panels]
    rows = math.ceil(len(told) / 3)
    size = (9.6, (1.9 + 0.62 * len(cases)) * rows / 2)
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(rows, 3, figsize=size, sharey=True, squeeze=False, layout="constrained")
        for axis, measure in zip(axes.flat, told, strict=False):
            for one in (one for one in pairs if one.metric == measure.name):
                _interval(axis, len(cases) - 1 - cases.index(one.a.split("/", 1)[1]), one, measure.scale)
            axis.axvline(0.0, color="#444444", linewidth=0.9, zorder=1.0)
            reach = 1.15 * max(map(abs, axis.dataLim.intervalx), default=1.0)
            reach = reach if np.isfinite(reach) and reach > 1e-9 else 1.0
            axis.set_xlim(-reach, reach)
            axis.set_title(measure.panels["differences"], fontsize=10)
            axis.grid(axis="y", visible=False)
            axis.set_ylim(-0.6, len(cases) - 0.4)
            axis.locator_params(axis="x", nbins=5)
        for axis in axes.flat[len(told) :]:
            axis.remove()
        axes[0, 0].set_yticks(range(len(cases)), [_case_name(case, several) for case in reversed(cases)])
        figure.supxlabel("point masses minus rigid bodies, on the same trials", fontsize=10)
    return figure


def _panels(study: xr.Dataset, draw: Callable[..., str], across: str, up: str) -> Figure:
    """Draws distributions, a panel for each estimator; `draw` returns what a line's label says of its case."""
    cases = [study.isel(case=index) for index in range(study.sizes["case"])]
    estimators = list(dict.fromkeys(str(case.estimator.item()) for case in cases))
    columns = min(2, len(estimators))
    rows = math.ceil(len(estimators) / columns)
    most = max(sum(case.estimator.item() == name for case in cases) for name in estimators)
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            rows,
            columns,
            figsize=(4.4 * columns, (2.5 + 0.2 * most) * rows),
            sharex=True,
            sharey=True,
            squeeze=False,
            layout="constrained",
        )
        for axis, estimator in zip(axes.flat, estimators, strict=False):
            of_method = [case for case in cases if case.estimator.item() == estimator]
            perceptions = dict.fromkeys(str(case.perception.item()) for case in of_method)
            for case in of_method:
                plant, perception = str(case.plant.item()), str(case.perception.item())
                several = len(perceptions) > 1
                colour = PERCEPTION_COLOURS[perception] if several else methods.colour(estimator)
                name = KINDS[plant].label
                if several:
                    name += f", {legend.PERCEPTION_NAMES[perception]}"
                counted = draw(axis, case, color=colour, linestyle=KINDS[plant].line, linewidth=1.7)
                axis.lines[-1].set_label(f"{name}: {counted}")
            axis.set_title(methods.label(estimator))
            axis.xaxis.set_tick_params(labelbottom=True)
            axis.set_xlabel(across)
            axis.legend(fontsize=8.5, loc="upper left", bbox_to_anchor=(-0.02, -0.2), handlelength=2.8)
        for axis in axes.flat[len(estimators) :]:
            axis.remove()
        for axis in axes[:, 0]:
            axis.set_ylabel(up)
        axes[0, 0].set_ylim(0.0, 1.02)
    return figure


def _steps(axis: Axes, values: Array, total: int, end: float, *, upside_down: bool = False, **look: Any) -> None:
    """Draws the share of `total` that is at most x, up to `end`; what has no value never counts."""
    ordered = np.sort(values)
    share = np.arange(len(ordered) + 1) / max(total, 1)
    share = 1.0 - share if upside_down else share
    axis.step(np.concatenate([[0.0], ordered, [end]]), np.append(share, share[-1]), where="post", **look)


def _interval(axis: Axes, place: int, one: Paired, scale: float) -> None:
    estimator = one.a.rsplit("/", 1)[1]
    if one.difference is None:
        return
    colour = methods.colour(estimator)
    if one.low is not None and one.high is not None:
        axis.plot([scale * one.low, scale * one.high], [place, place], color=colour, linewidth=2.4)
    axis.plot(scale * one.difference, place, "o", color=colour, markersize=6)


def _case_name(case: str, several: bool) -> str:
    """Returns the method's name, with its perception where there are several."""
    *perception, estimator = case.split("/")
    return methods.label(estimator, perception[0] if perception and several else None)
