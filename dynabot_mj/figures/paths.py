"""Paths of a trial, the plants side by side: Fig. 4 of the paper."""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dynabot_mj.common.legend import (
    PERCEPTION_NAMES,
    ROBOT_COLOURS,
)
from dynabot_mj.figures.style import STYLE
from dynabot_mj.perception import methods
from dynabot_mj.plants.kinds import KINDS
from dynabot_mj.study import assembly, configuration
from dynabot_mj.study.scenario import Scenario


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
            axes[0, column].set_title(KINDS[str(case.plant.item())].label)
            # The same limits for both plants, so that the paths can be compared.
            edge = assembly.field(setup, "perfect").leader.radius + setup.field.width
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


def _draw_paths(axis: Axes, case: xr.Dataset) -> None:
    path = case.trajectory_w.isel(recorded=0)
    for robot in range(path.sizes["robot"]):
        x, y = (path.isel(robot=robot).sel(axis=name) for name in ("x", "y"))
        colour = ROBOT_COLOURS[robot]
        axis.plot(x, y, color=colour, linewidth=1.3, label=f"robot {robot + 1}")
        axis.plot(x[0], y[0], "o", color=colour, markersize=4, fillstyle="none")
        axis.plot(x[-1], y[-1], "o", color=colour, markersize=6)


def _draw_well(axis: Axes, setup: Scenario, estimator: str) -> None:
    well = assembly.field(setup, estimator).leader
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
    name = methods.label(estimator)
    if perception:
        name += f", {PERCEPTION_NAMES[perception]}"
    return f"{name}, T_c = {1e3 * period:g} ms, trial {setup.first_trial} of seed {setup.seed}"
