"""The figure of a replay, in the style of the studies' figures."""

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.markers import MarkerStyle
from matplotlib.path import Path
from matplotlib.transforms import Affine2D

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.estimation.measurements import STALE
from dynabot_mj.experiments.estimators import estimate
from dynabot_mj.experiments.estimators.estimate import Replay
from dynabot_mj.figures.style import STYLE
from dynabot_mj.perception import methods
from dynabot_mj.sensing.logs.log import Log
from dynabot_mj.sensing.replay import Track

_TRUTH, _FIX = "#222222", "#B0B0B0"
_TRIANGLES = 16  # along a path
_TRIANGLE = Path([(1.0, 0.0), (-0.7, 0.5), (-0.7, -0.5), (1.0, 0.0)], closed=True)  # slender: it has to point
_POINTER: dict[str, Any] = {"markersize": 12.0, "markeredgecolor": "white", "markeredgewidth": 0.8}


def replay(found: Replay) -> Figure:
    """Draws the log as each estimator saw it, one in a column: as Fig. 3, and below what it was wrong by over time.

    Without the truth, what it believed to be wrong by, and the age of its last believed fix.

    Args:
        found: Of `experiments.estimate.run`.

    Returns:
        The figure; metres, degrees, seconds since the log's first row.
    """
    log = found.log
    judged = log.position_w is not None or log.heading is not None
    columns = len(found.tracks)
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            4,
            columns,
            figsize=(4.6 * columns + (1.4 if columns == 1 else 0.0), 11.0),
            squeeze=False,
            height_ratios=(3.0, 1.0, 1.0, 1.0),
            layout=ConstrainedLayoutEngine(h_pad=0.08, w_pad=0.08),
        )
        for column, (name, track) in enumerate(found.tracks.items()):
            shown = axes[:, column]
            shown[0].set_title(methods.label(name))
            _draw_map(shown[0], log, name, track)
            (_draw_errors if judged else _draw_beliefs)(shown[1:], log, name, track)
            for axis in shown[1:]:
                axis.set_xlim(0.0, log.time[-1] - log.time[0])
            shown[-1].set_xlabel("time [s]")
            if column > 0:
                for axis in shown:
                    axis.set_ylabel("")
        _equalise(axes, found)
        handles, labels = axes[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), fontsize=9)
        figure.suptitle(f"Replay of {found.name}", fontsize=11)
    return figure


def _draw_map(axis: Axes, log: Log, name: str, track: Track) -> None:
    known = track.known[:, 0]
    x, y = _shown(track.position_w[:, 0], known).T
    axis.plot(*log.fix_position_w.T, ".", color=_FIX, markersize=3.0, label="fixes")
    if log.position_w is not None:
        axis.plot(*log.position_w.T, color=_TRUTH, linewidth=1.0, linestyle="--", label="truth")
    axis.plot(x, y, color=methods.colour(name), linewidth=1.1)
    # Evenly along the time that is known.
    rows = np.flatnonzero(known)
    rows = rows[np.linspace(0, len(rows) - 1, min(_TRIANGLES, len(rows))).astype(int)]
    for row in rows:
        marker = MarkerStyle(_TRIANGLE, transform=Affine2D().rotate(track.heading[row, 0]))
        axis.plot(x[row], y[row], marker=marker, **_POINTER, color=methods.colour(name))
    axis.plot([], [], marker=_TRIANGLE, **_POINTER, color="#777777", linewidth=1.3, label="estimate and its heading")
    axis.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")


def _draw_errors(axes: Array, log: Log, name: str, track: Track) -> None:
    """Draws errors of x, y and heading between three deviations of what the estimator believed."""
    wrong, known = estimate.errors(log, track), track.known[:, 0]
    sigma = estimate.position_sigma(track)
    for axis, label, values, deviation in (
        (axes[0], "x error [m]", wrong.position_w[:, 0], sigma[:, 0]),
        (axes[1], "y error [m]", wrong.position_w[:, 1], sigma[:, 1]),
        (axes[2], "heading error [deg]", np.degrees(wrong.heading), np.degrees(np.sqrt(track.heading_variance[:, 0]))),
    ):
        time, bound = log.time - log.time[0], 3.0 * _shown(deviation, known)
        axis.fill_between(time, -bound, bound, color=methods.colour(name), alpha=0.18, linewidth=0.0)
        axis.plot(time, values, color=methods.colour(name), linewidth=1.0)
        axis.axhline(0.0, color=_TRUTH, linewidth=0.6)
        axis.set_ylabel(label)
    axes[0].set_title("error, and three standard deviations as believed", fontsize=9)


def _draw_beliefs(axes: Array, log: Log, name: str, track: Track) -> None:
    """Draws the deviations that the estimator believed, and the age of the last fix that it believed."""
    known, colour, time = track.known[:, 0], methods.colour(name), log.time - log.time[0]
    sigma = _shown(estimate.position_sigma(track), known)
    heading = _shown(np.degrees(np.sqrt(track.heading_variance[:, 0])), known)
    axes[0].plot(time, np.hypot(*sigma.T), color=colour, linewidth=1.0)
    axes[1].plot(time, heading, color=colour, linewidth=1.0)
    axes[2].plot(time, _shown(track.fix_age[:, 0], known), color=colour, linewidth=1.0)
    axes[2].axhline(STALE, color=_TRUTH, linewidth=0.8, linestyle=":")
    for axis, label in zip(axes, ("position sigma [m]", "heading sigma [deg]", "fix age [s]"), strict=True):
        axis.set_ylabel(label)
        axis.set_ylim(bottom=0.0)
    axes[0].set_title("standard deviations as believed", fontsize=9)
    axes[2].set_title(f"last believed fix; stale above {STALE:g} s", fontsize=9)


def _equalise(axes: Array, found: Replay) -> None:
    """Gives all maps one square, and all other panels of a row one scale."""
    places = [found.log.fix_position_w]
    places += [] if found.log.position_w is None else [found.log.position_w]
    places += [_shown(track.position_w[:, 0], track.known[:, 0]) for track in found.tracks.values()]
    low, high = np.nanmin(np.concatenate(places), axis=0), np.nanmax(np.concatenate(places), axis=0)
    middle, half = 0.5 * (low + high), 0.54 * float((high - low).max()) + 0.1
    for axis in axes[0]:
        axis.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half))
    for row in axes[1:]:
        limits = np.array([axis.get_ylim() for axis in row])
        for axis in row:
            axis.set_ylim(limits[:, 0].min(), limits[:, 1].max())


def _shown(values: Array, known: BoolArray) -> Array:
    """Returns values, (N, ...), with those left out where nothing is known."""
    return np.where(known.reshape(-1, *[1] * (values.ndim - 1)), values, np.nan)
