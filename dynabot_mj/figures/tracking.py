"""Figures of the tuning and of the tracking report, in the style of the studies' figures."""

from collections.abc import Mapping, Sequence

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dynabot_mj.common.legend import ROBOT_COLOURS
from dynabot_mj.experiments.vehicle import manoeuvres
from dynabot_mj.experiments.vehicle.parity import Parity
from dynabot_mj.experiments.vehicle.track import TrackReport
from dynabot_mj.experiments.vehicle.tracking import Tracking
from dynabot_mj.experiments.vehicle.tune_traction import Result
from dynabot_mj.figures.style import STYLE

_PARTICLE = "#777777"


def tuning(result: Result) -> Figure:
    """Draws the cost over the iterations, three courses before and after, and the validation.

    Args:
        result: Of `experiments.tune_traction.run`.
    """
    names = (result.request.against, "tuned")
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(2, 3, figsize=(14.0, 7.6), layout="constrained")
        axis = axes[0, 0]
        axis.set_title("cost in the planar model")
        axis.plot(result.solution.history, color=ROBOT_COLOURS[0], marker="o", markersize=3)
        axis.axhline(result.solution.cost_before, color=_PARTICLE, linestyle="--", linewidth=1.0, label="start")
        axis.set(xlabel="iteration", ylabel="cost [m²/s²]", ylim=(0.0, None))
        axis.legend()
        shown = _telling(result)
        for axis, index in zip(axes.flat[1:5], shown, strict=False):
            tracks = dict(zip(names, (result.before, result.after), strict=True))
            _draw_speed(axis, tracks, index)
            kind = result.courses.gain[index] > 0.0
            axis.set_title(f"course {index + 1} of the tuning, in MuJoCo" + (": a well" if kind else ""))
        axes[0, 1].legend()
        _draw_validation(axes[1, 2], result, names)
    return figure


def parity(found: Parity) -> Figure:
    """Draws both models' signals on the acceptance course.

    Args:
        found: Of `experiments.parity.parity`.
    """
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(len(found.signals), 1, figsize=(12.0, 9.0), sharex=True, layout="constrained")
        for index, axis in enumerate(axes):
            axis.plot(found.time, found.mujoco[:, index], color=ROBOT_COLOURS[0], label="MuJoCo")
            axis.plot(found.time, found.planar[:, index], color=ROBOT_COLOURS[5], linestyle="--", label="planar model")
            axis.set_ylabel(found.signals[index].replace(" [", "\n["))
            axis.annotate(
                f"RMS {100.0 * found.error[index]:.1f} %\nof the range",
                (1.01, 0.5),
                xycoords="axes fraction",
                va="center",
                fontsize=9,
            )
            for end in found.end[:-1]:
                axis.axvline(end, color=_PARTICLE, linewidth=0.6)
        axes[0].legend(loc="upper right")
        starts = [0.0, *found.end[:-1]]
        for name, start, end in zip(found.names, starts, found.end, strict=True):
            axes[0].annotate(
                name.replace(" m/s, ", " m/s,\n").replace("corner ", "corner\n"),
                ((start + end) / 2.0, 1.04),
                xycoords=("data", "axes fraction"),
                ha="center",
                va="bottom",
                fontsize=8,
            )
        axes[-1].set(xlabel="time [s], one manoeuvre after another", xlim=(0.0, found.end[-1]))
    return figure


def tracking(report: TrackReport) -> Figure:
    """Draws one course of each kind, the formation's velocity error over time, and its RMS over friction.

    Args:
        report: Of `experiments.track.run`.
    """
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(2, 4, figsize=(16.0, 7.2), dpi=100, layout="constrained")
        for index, (axis, kind) in enumerate(zip(axes.flat, manoeuvres.KINDS, strict=False)):
            _draw_speed(axis, report.examples, index)
            axis.set_title(kind)
        axes[0, 0].legend(fontsize=8)
        axis = axes[1, 2]
        axis.set_title("formation, perfect information, 36 ms")
        for colour, (label, errors) in zip(_colours(), report.errors_by_time.items(), strict=False):
            axis.plot(np.arange(len(errors)) + 0.5, errors, color=colour, label=label)
        axis.set(xlabel="time [s]", ylabel="RMS velocity error [m/s]", xlim=(0.0, 60.0), ylim=(0.0, None))
        axis.legend(fontsize=8)
        axis = axes[1, 3]
        axis.set_title(f"the same over friction, {report.frictions[0].laws}")
        friction = [one.friction for one in report.frictions]
        ratio = [
            np.nan
            if one.formation_s.mean is None or one.particle_formation_s.mean is None
            else one.formation_s.mean / one.particle_formation_s.mean
            for one in report.frictions
        ]
        for values, colour, marker, label in (
            (ratio, ROBOT_COLOURS[0], "o", "time to formation / particles'"),
            ([one.velocity_rms_mps for one in report.frictions], ROBOT_COLOURS[5], "s", "velocity RMS [m/s]"),
            ([one.largest_slip_mps for one in report.frictions], ROBOT_COLOURS[2], "^", "largest slip [m/s]"),
        ):
            axis.plot(friction, values, color=colour, marker=marker, label=label)
        axis.set(xlabel="friction", ylabel="as labelled", ylim=(0.0, None))
        axis.legend(fontsize=8)
    return figure


def _draw_speed(axis: Axes, tracks: Mapping[str, Tracking], index: int) -> None:
    """Draws how fast particle and vehicles move on a course."""
    particle = next(iter(tracks.values())).particle
    speed = np.linalg.norm(particle.velocity_w[index], axis=-1)
    axis.plot(particle.time, speed, color=_PARTICLE, linewidth=3.5, alpha=0.5, label="particle")
    for colour, (label, track) in zip(_colours(), tracks.items(), strict=False):
        speed = np.linalg.norm(track.vehicle.velocity_w[index], axis=-1)
        axis.plot(track.vehicle.time, speed, color=colour, linewidth=1.2, label=label)
    axis.set(xlabel="time [s]", ylabel="speed [m/s]", xlim=(0.0, particle.time[-1]), ylim=(0.0, None))


def _draw_validation(axis: Axes, result: Result, names: Sequence[str]) -> None:
    """Draws each held-out course's cost before and after."""
    before, after = result.validation.cost_before, result.validation.cost_after
    high = 1.1 * max(before.max(), after.max())
    axis.set_title(f"validation in MuJoCo: {len(before)} other courses")
    axis.plot([0.0, high], [0.0, high], color=_PARTICLE, linewidth=1.0, linestyle="--", label="equal")
    axis.plot(before, after, "o", color=ROBOT_COLOURS[0], label="a course, mean over conditions")
    axis.set(xlabel=f"cost, {names[0]} [m²/s²]", ylabel=f"cost, {names[1]} [m²/s²]", xlim=(0.0, high), ylim=(0.0, high))
    axis.legend(loc="upper left")


def _telling(result: Result) -> list[int]:
    """Returns the courses on which the two gain sets differ most."""
    change = np.abs(result.before.velocity_error - result.after.velocity_error)
    return sorted(np.argsort(change)[-4:].tolist())


def _colours() -> list[str]:
    return [ROBOT_COLOURS[index] for index in (5, 0, 1, 2)]
