"""Figures over time of single trials, one of each case: a row for each method, a column for each plant."""

import math
from collections.abc import Callable, Sequence
from typing import Literal

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator
from numpy.lib.stride_tricks import sliding_window_view

from dynabot_mj.common.arrays import Array
from dynabot_mj.common.legend import ROBOT_COLOURS
from dynabot_mj.figures.style import STYLE
from dynabot_mj.perception import methods
from dynabot_mj.plants.kinds import KINDS
from dynabot_mj.study import assembly
from dynabot_mj.viewing.recording import Recording

_MEAN = "#111111"
_DISTANCES = (0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0)  # that have a tick [m]
_WINDOW = 2.0  # over which forces and the ages of messages are averaged [s]


def distance(recordings: Sequence[Recording]) -> Figure:
    """Draws the robots' distances to the leader, their mean, and the floor of its well."""

    def draw(axis: Axes, recording: Recording) -> None:
        well = assembly.field(recording.setup, recording.case.estimator).leader
        axis.axhspan(well.radius, well.radius + well.width, color="#000000", alpha=0.07, linewidth=0.0, label="floor")
        distances = np.linalg.norm(recording.position_w, axis=-1)
        _draw_robots(axis, recording.time, distances)
        axis.plot(recording.time, distances.mean(axis=-1), color=_MEAN, linewidth=1.4, label="mean")
        # The way there and what happens on the floor, in one panel.
        axis.set_yscale("log")
        axis.yaxis.set_major_locator(FixedLocator(_DISTANCES))
        axis.yaxis.set_major_formatter("{x:g}")
        axis.yaxis.set_minor_locator(NullLocator())

    return _grid(recordings, draw, "distance to the leader [m]", share="all")


def message_age(recordings: Sequence[Recording]) -> Figure:
    """Draws how old the positions are that robots have of their neighbours, over all pairs."""

    def draw(axis: Axes, recording: Recording) -> None:
        pairs = ~np.eye(recording.heard_age.shape[-1], dtype=bool)
        low, mean, high = _running(recording.time, 1e3 * recording.heard_age[:, pairs])
        colour = methods.colour(recording.case.estimator)
        axis.fill_between(
            recording.time, low, high, color=colour, alpha=0.18, linewidth=0.0, label=f"all pairs within {_WINDOW:g} s"
        )
        axis.plot(recording.time, mean, color=colour, linewidth=1.4, label="their mean")

    return _grid(recordings, draw, "age of what was heard [ms]", share="row")


def effort(recordings: Sequence[Recording]) -> Figure:
    """Draws the forces that the robots command, and their running mean."""

    def draw(axis: Axes, recording: Recording) -> None:
        forces = np.linalg.norm(recording.force_w, axis=-1)
        _draw_robots(axis, recording.time, forces, alpha=0.45, linewidth=0.5)
        _, mean, _ = _running(recording.time, forces)
        axis.plot(recording.time, mean, color=_MEAN, linewidth=1.4, label=f"mean over {_WINDOW:g} s")

    return _grid(recordings, draw, "commanded force [N]", share="all")


def slip(recordings: Sequence[Recording]) -> Figure | None:
    """Draws the largest slip of each robot's tyres; None where all are point masses."""
    bodies = [one for one in recordings if KINDS[one.case.plant].body]

    def draw(axis: Axes, recording: Recording) -> None:
        _draw_robots(axis, recording.time, recording.slip)

    return _grid(bodies, draw, "largest slip of a tyre [m/s]", share="all") if bodies else None


def estimate_error(recordings: Sequence[Recording]) -> Figure | None:
    """Draws the first robot's error of its own x, and three deviations of what it believes of that.

    Returns:
        The figure; None where all robots know where they are.
    """
    unsure = [one for one in recordings if one.case.perception is not None]

    def draw(axis: Axes, recording: Recording) -> None:
        error = recording.believed_w[:, 0, 0] - recording.position_w[:, 0, 0]
        bound = 3.0 * np.sqrt(recording.covariance[:, 0, 0, 0])
        colour = methods.colour(recording.case.estimator)
        axis.fill_between(
            recording.time, -bound, bound, color=colour, alpha=0.18, linewidth=0.0, label="±3σ, as believed"
        )
        axis.plot(recording.time, error, color=colour, linewidth=0.7, label="error")
        axis.axhline(0.0, color=_MEAN, linewidth=0.6)

    return _grid(unsure, draw, "error of robot 1's x [m]", share="row") if unsure else None


def _grid(
    recordings: Sequence[Recording], draw: Callable[[Axes, Recording], None], up: str, share: Literal["all", "row"]
) -> Figure:
    """Draws a panel for each recording.

    Args:
        recordings: Not empty.
        draw: Draws into a panel; equal things have equal labels.
        up: What is drawn, and its unit.
        share: Which panels have one scale: all, or row.
    """
    plants = list(dict.fromkeys(one.case.plant for one in recordings))
    methods = list(dict.fromkeys((one.case.estimator, one.case.perception) for one in recordings))
    several = len({perception for _, perception in methods if perception}) > 1
    columns = max(len(plants), min(2, len(methods)))  # one plant's methods stand side by side
    rows = math.ceil(len(methods) * len(plants) / columns)
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            rows,
            columns,
            figsize=(1.0 + 4.2 * columns, 1.1 + 1.75 * rows),
            sharex=rows * columns == len(recordings),
            sharey=share if len(plants) == columns else "all",
            squeeze=False,
            layout="constrained",
        )
        for recording in recordings:
            case = recording.case
            method = methods.index((case.estimator, case.perception))
            axis = axes.flat[method * len(plants) + plants.index(case.plant)]
            draw(axis, recording)
            axis.set_title(_title(recording, several), fontsize=9.5, loc="left")
            axis.set_xlim(0.0, recording.time[-1])
        for axis in axes.flat[len(recordings) :]:
            axis.remove()
        for axis in axes[-1]:
            axis.set_xlabel("time [s]")
        figure.supylabel(up, fontsize=10)
        handles, labels = axes[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 5), fontsize=9)
    return figure


def _draw_robots(axis: Axes, time: Array, values: Array, alpha: float = 0.9, linewidth: float = 0.9) -> None:
    """Draws a line for each robot, (K, n)."""
    for robot, colour in zip(range(values.shape[1]), ROBOT_COLOURS, strict=False):
        axis.plot(time, values[:, robot], color=colour, alpha=alpha, linewidth=linewidth, label=f"robot {robot + 1}")


def _running(time: Array, values: Array) -> tuple[Array, Array, Array]:
    """Returns lowest, mean and highest of the values around each time; NaN where there are none.

    Args:
        time: Even, (K,) [s].
        values: Of several robots or pairs, (K, N); NaN does not count.
    """
    half = max(1, round(_WINDOW / 2.0 / (time[1] - time[0])))
    padded = np.pad(values, ((half, half), (0, 0)), constant_values=np.nan)
    around = sliding_window_view(padded, 2 * half + 1, axis=0).reshape(len(time), -1)
    counted = np.isfinite(around)
    count = counted.sum(axis=1)
    nothing = np.where(count > 0, 0.0, np.nan)
    low = np.where(counted, around, np.inf).min(axis=1)
    high = np.where(counted, around, -np.inf).max(axis=1)
    mean = np.where(counted, around, 0.0).sum(axis=1) / np.maximum(count, 1)
    return np.where(count > 0, low, np.nan), mean + nothing, np.where(count > 0, high, np.nan)


def _title(recording: Recording, several: bool) -> str:
    """Returns a panel's title, with the perception where there are several."""
    case = recording.case
    return f"{methods.label(case.estimator, case.perception if several else None)}, {KINDS[case.plant].label}"
