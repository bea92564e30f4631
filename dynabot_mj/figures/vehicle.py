"""The figure of the acceptance drive, in the style of the studies' figures."""

import math
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dynabot_mj.common.legend import ROBOT_COLOURS
from dynabot_mj.experiments.vehicle.drive import DriveReport
from dynabot_mj.experiments.vehicle.drive_figures import SPUN_OUT
from dynabot_mj.experiments.vehicle.drives import SLIDES
from dynabot_mj.figures.style import STYLE

PAPER_SPEED = 10.0  # top speed [m/s], Sec. II
_MARKERS = ("o", "s", "^", "D")
_REFERENCE = "#777777"


def acceptance_drive(report: DriveReport) -> Figure:
    """Draws what the drive measured, a manoeuvre in each panel.

    Args:
        report: Of `experiments.drive.drive`.

    Returns:
        The figure; SI units, degrees and centimetres as the axes say.
    """
    figures = report.figures
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(2, 4, figsize=(16.0, 7.4), layout="constrained")
        _draw_launch(axes[0, 0], report)
        _draw_motor(axes[0, 1], report)
        _draw_turns(axes[0, 2], report)
        _draw_slopes(axes[0, 3], report)
        _draw_corners(axes[1, 0], axes[1, 1], report)
        _draw_energy(axes[1, 2], report)
        _draw_collision(axes[1, 3], report)
        figure.suptitle(
            f"Acceptance drive: {figures.mass_kg:g} kg, friction {figures.friction:g}, "
            f"physics step {figures.timestep_ms:g} ms",
            fontsize=12,
        )
    return figure


def _draw_launch(axis: Axes, report: DriveReport) -> None:
    until = 2.0 * report.figures.time_to_95_percent_s
    axis.set_title("launch, and braking from 5 m/s")
    for trace, colour, label in (
        (report.launch, ROBOT_COLOURS[0], "launch"),
        (report.brake, ROBOT_COLOURS[5], "braking"),
    ):
        shown = trace.time <= until
        axis.plot(trace.time[shown], trace.velocity_b[shown, 0, 0], color=colour, label=label)
    axis.axhline(PAPER_SPEED, color=_REFERENCE, linestyle="--", linewidth=1.0, label="paper, 10 m/s")
    axis.set(xlabel="time [s]", ylabel="speed [m/s]", xlim=(0.0, until), ylim=(0.0, None))
    axis.legend(loc="center right")


def _draw_motor(axis: Axes, report: DriveReport) -> None:
    vehicle, trace = report.robot.vehicle, report.launch
    shown = trace.time <= 2.0 * report.figures.time_to_95_percent_s
    current = trace.torque[:, 0].mean(axis=-1) / vehicle.torque_constant
    voltage = vehicle.resistance * current + vehicle.torque_constant * trace.wheel_speed[:, 0].mean(axis=-1)
    axis.set_title("a motor in the launch (mean of four)")
    axis.plot(trace.time[shown], voltage[shown], color=ROBOT_COLOURS[2], label="voltage [V]")
    axis.plot(trace.time[shown], current[shown], color=ROBOT_COLOURS[1], linestyle="-.", label="current [A]")
    for limit in (vehicle.voltage, vehicle.current_limit):
        axis.axhline(limit, color=_REFERENCE, linestyle=":", linewidth=1.2, label="limits")
    handles, labels = axis.get_legend_handles_labels()
    axis.legend(handles[:3], labels[:3], loc="center right")
    axis.set(xlabel="time [s]", ylabel="voltage [V], current [A]", xlim=(0.0, trace.time[shown][-1]), ylim=(0.0, None))


def _draw_turns(axis: Axes, report: DriveReport) -> None:
    ratios = report.figures.turn_rate_over_theory
    axis.set_title("turn in place against Coulomb friction")
    axis.axhspan(0.95, 1.08, color=ROBOT_COLOURS[4], alpha=0.18, linewidth=0.0, label="accepted")
    axis.axhline(1.0, color=_REFERENCE, linestyle="--", linewidth=1.0, label="theory")
    speeds = [float(speed) for speed in ratios]
    axis.plot(speeds, list(ratios.values()), "o-", color=ROBOT_COLOURS[0], label="worse of both signs")
    low, high = min(0.86, *ratios.values()), max(1.12, *ratios.values())
    axis.set(xlabel="commanded wheel speed, ± [rad/s]", ylabel="yaw rate / theory [-]")
    axis.set(xticks=speeds, xlim=(0.0, max(speeds) + 10.0), ylim=(low - 0.01, high + 0.01))
    axis.legend(loc="lower right")


def _draw_slopes(axis: Axes, report: DriveReport) -> None:
    figures = report.figures
    axis.set_title("creep on slopes, wheels commanded 0")
    for index, (creep, label) in enumerate(
        ((figures.slope_creep_mmps, "facing uphill"), (figures.slope_creep_across_mmps, "standing across"))
    ):
        slopes = [float(slope) for slope in creep]
        axis.semilogy(
            slopes, list(creep.values()), f"{_MARKERS[index]}-", color=ROBOT_COLOURS[2 * index + 1], label=label
        )
    axis.set(xlabel="rise per metre [-]", ylabel="creep [mm/s]", xticks=slopes)
    axis.margins(x=0.15, y=0.3)
    axis.legend(loc="center right")


def _draw_corners(path: Axes, slip: Axes, report: DriveReport) -> None:
    corners = report.figures.cornering
    path.set_title("corners without yaw feedback")
    slip.set_title("side slip in these corners")
    for index, speed in enumerate(sorted({corner.speed_mps for corner in corners})):
        of_speed = [corner for corner in corners if corner.speed_mps == speed]
        differences = [corner.wheel_difference_radps for corner in of_speed]
        look: dict[str, Any] = {"color": ROBOT_COLOURS[index], "label": f"{speed:g} m/s"}
        radii = [np.nan if corner.radius_m is None else corner.radius_m for corner in of_speed]
        marker = (*_MARKERS, "v")[index % 5]
        path.semilogy(differences, radii, f"{marker}-", **look)
        slip.plot(differences, [corner.side_slip_deg for corner in of_speed], f"{marker}-", **look)
    slip.axhline(math.degrees(SPUN_OUT), color=_REFERENCE, linestyle="--", linewidth=1.0, label="spun out above")
    path.set(xlabel="commanded wheel difference [rad/s]", ylabel="turning radius [m], none if spun out")
    slip.set(xlabel="commanded wheel difference [rad/s]", ylabel="largest side slip [deg]", ylim=(-5.0, 185.0))
    for axis in (path, slip):
        axis.set_xticks(differences)
        axis.legend(fontsize=9, loc="upper right" if axis is path else "upper left")


def _draw_energy(axis: Axes, report: DriveReport) -> None:
    axis.set_title("free slides, motors off")
    for index, (time, energy) in enumerate(report.energy):
        ahead, left, yaw_rate = SLIDES[index]
        axis.plot(
            time,
            energy - report.resting_energy,
            color=ROBOT_COLOURS[index],
            linestyle=("-", "--", "-.")[index % 3],
            label=f"{ahead:g} m/s ahead, {left:g} m/s left, {yaw_rate:g} rad/s",
        )
    axis.set(xlabel="time [s]", ylabel="kinetic + potential energy above rest [J]", xlim=(0.0, time[-1]))
    axis.set_ylim(0.0, 1.45 * axis.get_ylim()[1])
    axis.legend(fontsize=9, loc="upper right")


def _draw_collision(axis: Axes, report: DriveReport) -> None:
    axis.set_title("head-on at 3 + 3 m/s")
    length = report.robot.vehicle.length
    for index, trace in enumerate(report.collisions):
        gap = 100.0 * (np.abs(trace.qpos[:, 1, 0] - trace.qpos[:, 0, 0]) - length)
        since = 1e3 * (trace.time - trace.time[trace.touched])
        shown = (since > -15.0) & (since < 120.0)
        label = "each phase of the step" if index == 0 else None
        axis.plot(since[shown], gap[shown], color=ROBOT_COLOURS[0], alpha=0.55, linewidth=1.1, label=label)
    axis.axhline(0.0, color="#444444", linewidth=1.0)
    axis.axhline(-2.0, color=_REFERENCE, linestyle="--", linewidth=1.0, label="accepted, 2 cm overlap")
    axis.set(xlabel="time since the first contact [ms]", ylabel="gap between the hulls [cm]", ylim=(-4.0, 6.0))
    axis.legend(loc="upper right")
