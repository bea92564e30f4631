"""Figures of the tether experiment: the paper's Fig. 3, and errors beside what the filters believed of them."""

import string

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.markers import MarkerStyle
from matplotlib.path import Path
from matplotlib.transforms import Affine2D

from dynabot_mj.common.arrays import Array
from dynabot_mj.estimation.measurements import rotation, wrap
from dynabot_mj.experiments.estimators import circle
from dynabot_mj.experiments.estimators.circle import CircleOutcome, Runs
from dynabot_mj.figures.style import STYLE
from dynabot_mj.perception import methods

_RUN = 0  # which of the example's is drawn
_ACTUAL, _FITTED, _FARTHEST = "#B8B8B8", "#111111", "#D00000"
_TRIANGLE = Path(np.array([(1.0, 0.0), (-0.8, 0.6), (-0.8, -0.6), (1.0, 0.0)]), closed=True)  # points along +x
_BETWEEN_TRIANGLES = 2.5  # [s]


def paths(outcome: CircleOutcome) -> Figure:
    """Draws Fig. 3: the first run's estimated and actual path, one panel for each estimator.

    Args:
        outcome: Of `experiments.circle.run`.

    Returns:
        The figure; positions in metres, a line's along and across it.
    """
    along = outcome.request.path == "line"
    with plt.rc_context(STYLE):
        names = outcome.request.estimators
        count = len(names)
        wide = (0.1 + 3.8 * count, 1.6 + 3.3 * _slimness(outcome))
        arrangement, size = ((count, 1), (10.0, 2.8 * count)) if along else ((1, count), wide)
        figure, axes = plt.subplots(*arrangement, figsize=size, sharex=True, sharey=True, layout="constrained")
        for axis, name, letter in zip(axes, names, string.ascii_lowercase, strict=False):
            farthest = _draw_paths(axis, outcome, name)
            axis.set_title(
                f"({letter}) {methods.label(name)}" + (f": {farthest:.2f} m" if np.isfinite(farthest) else "")
            )
            if along:
                axis.set_ylabel("across [m]")
            else:
                axis.set(aspect="equal", xlabel="x [m]")
        axes[-1 if along else 0].set(**({"xlabel": "along [m]"} if along else {"ylabel": "y [m]"}))
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=5, fontsize=9)
        figure.suptitle(f"{_caption(outcome)} from {circle.DROPPED:g} s on", fontsize=11)
    return figure


def errors(outcome: CircleOutcome) -> Figure:
    """Draws the first run's errors of position and heading over time, with three deviations of each filter's belief.

    Args:
        outcome: Of `experiments.circle.run`.

    Returns:
        The figure; one scale for all estimators.
    """
    chunk = outcome.example
    with plt.rc_context(STYLE):
        names = outcome.request.estimators
        size = (14.0 / 3.0 * len(names), 7.6)
        figure, axes = plt.subplots(3, len(names), figsize=size, sharex=True, sharey="row", layout="constrained")
        for column, name in zip(axes.T, names, strict=True):
            column[0].set_title(methods.label(name))
            for axis, (wrong, deviation) in zip(column, _errors(chunk, name), strict=True):
                _draw_error(axis, chunk.truth.time, wrong, deviation, methods.colour(name))
            column[-1].set(xlabel="time [s]", xlim=(0.0, chunk.truth.time[-1]))
        labels = ("error of x [m]", "error of y [m]", "error of heading [deg]")
        for axis, label, largest in zip(axes[:, 0], labels, _largest(chunk), strict=True):
            axis.set(ylabel=label, ylim=(-1.08 * largest, 1.08 * largest))
        handles, labels = axes[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3, fontsize=9)
        figure.suptitle(_caption(outcome), fontsize=11)
    return figure


def _draw_paths(axis: Axes, outcome: CircleOutcome, name: str) -> float:
    """Draws one estimator's panel and returns the largest distance from the best fit [m]."""
    chunk = outcome.example
    track, fitted = chunk.tracks[name], chunk.fits[name]
    judged = slice(chunk.first, None)
    origin_w, turn = np.zeros(2), 0.0
    if outcome.request.path == "line":
        origin_w, turn = chunk.truth.position_w[0, _RUN], -chunk.truth.heading[0, _RUN]

    def shown(position_w: Array) -> Array:
        """Returns x and y in the panel, (2, K)."""
        return rotation(np.asarray(turn)) @ (position_w - origin_w).T

    known = track.known[judged, _RUN]
    estimate = np.where(known, shown(track.position_w[judged, _RUN]), np.nan)
    colour = methods.colour(name)
    axis.plot(*shown(chunk.truth.position_w[judged, _RUN]), color=_ACTUAL, linewidth=3.0, label="actual path")
    axis.plot(*estimate, color=colour, linewidth=0.8, alpha=0.75, label="estimated path")
    axis.plot(*shown(fitted.path_w[:, _RUN]), color=_FITTED, linewidth=1.2, label="best-fit actual path")
    every = round(_BETWEEN_TRIANGLES / outcome.request.period)
    bearing = track.heading[judged, _RUN] + turn
    for index in np.flatnonzero(known)[::every]:
        marker = MarkerStyle(_TRIANGLE, transform=Affine2D().rotate(bearing[index]))
        axis.plot(*estimate[:, index], marker=marker, markersize=10, color=colour, markeredgecolor="white")
    axis.plot([], [], ">", color=colour, markersize=8, label="estimated heading")
    farthest = float(chunk.scores[name].uncertainty[_RUN])
    if np.isfinite(farthest):
        index = int(fitted.distance[:, _RUN].argmax())
        ends_w = np.stack([fitted.nearest_w[index, _RUN], track.position_w[chunk.first + index, _RUN]])
        axis.plot(*shown(ends_w), color=_FARTHEST, linewidth=1.6, zorder=4.0)
        axis.plot(
            *shown(ends_w[1:]), "o", color=_FARTHEST, markersize=9, fillstyle="none", zorder=4.0, label="farthest point"
        )
    return farthest


def _errors(chunk: Runs, name: str) -> tuple[tuple[Array, Array], ...]:
    """Returns errors and believed deviations of x, y [m] and heading [deg], each (N,); NaN where nothing is known."""
    track, truth = chunk.tracks[name], chunk.truth
    unknown = np.where(track.known[:, _RUN], 0.0, np.nan)
    wrong_w = track.position_w[:, _RUN] - truth.position_w[:, _RUN]
    variance = np.diagonal(track.position_covariance[:, _RUN], axis1=-2, axis2=-1)
    turned = np.degrees(wrap(track.heading[:, _RUN] - truth.heading[:, _RUN]))
    deviation = np.degrees(np.sqrt(track.heading_variance[:, _RUN]))
    return (
        *((wrong_w[:, axis] + unknown, np.sqrt(variance[:, axis]) + unknown) for axis in (0, 1)),
        (turned + unknown, deviation + unknown),
    )


def _largest(chunk: Runs) -> Array:
    """Returns what each row of panels has to reach, (3,): all errors, and the bounds once the filters have settled."""
    shown = [
        [
            np.nanmax(np.append(np.abs(wrong), 3.0 * deviation[chunk.first :]))
            for wrong, deviation in _errors(chunk, name)
        ]
        for name in chunk.tracks
        if chunk.tracks[name].known[:, _RUN].any()
    ]
    return np.max(np.array([[1e-3] * 3, *shown]), axis=0)


def _draw_error(axis: Axes, time: Array, wrong: Array, deviation: Array, colour: str) -> None:
    axis.fill_between(
        time, -3.0 * deviation, 3.0 * deviation, color=colour, alpha=0.18, linewidth=0.0, label="±3σ, as believed"
    )
    axis.plot(time, wrong, color=colour, linewidth=0.9, label="error")
    axis.axhline(0.0, color=_FITTED, linewidth=0.6)
    axis.axvspan(0.0, circle.DROPPED, color="#000000", alpha=0.07, linewidth=0.0, label="not judged")


def _slimness(outcome: CircleOutcome) -> float:
    """Returns height over width of what the panels show."""
    chunk = outcome.example
    places = [track.position_w[track.known[:, _RUN], _RUN] for track in chunk.tracks.values()]
    width, height = np.ptp(np.concatenate([*places, chunk.truth.position_w[:, _RUN]]), axis=0)
    return float(np.clip(height / width, 0.3, 1.5))


def _caption(outcome: CircleOutcome) -> str:
    asked = outcome.request
    return f"{asked.path}, {asked.plant} plant, T_s = {1e3 * asked.period:g} ms: first run of seed {asked.seed}"
