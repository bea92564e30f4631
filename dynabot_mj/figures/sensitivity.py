"""The figure of `dynabot compare --sensitivity`: what each reading of the paper changes."""

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from dynabot_mj.experiments.formation.case_rows import CaseRow
from dynabot_mj.experiments.formation.sensitivity import Sensitivity, value
from dynabot_mj.figures.style import STYLE
from dynabot_mj.perception import methods

_PANELS = {
    "arrival_s": ("arrival [s], mean ± sd", 1.0),
    "time_to_formation_s": ("time to formation [s]", 1.0),
    "collision_footprint": ("hulls overlap [%]", 100.0),
    "completion_common": ("formation within 1 m [%]", 100.0),
}


def sensitivity(result: Sensitivity) -> Figure:
    """Draws each measure over the readings, one mark and interval for each estimator."""
    estimators = list(dict.fromkeys(row.estimator for row in result.found[0].rows))
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            1, len(_PANELS), figsize=(11.0, 1.6 + 0.3 * len(result.found)), sharey=True, layout="constrained"
        )
        for axis, (metric, (title, scale)) in zip(axes, _PANELS.items(), strict=True):
            for place, found in enumerate(result.found):
                for row in found.rows:
                    shift = 0.22 * (estimators.index(row.estimator) - (len(estimators) - 1) / 2.0)
                    middle, low, high = (None if x is None else scale * x for x in _interval(row, metric))
                    if middle is None:
                        continue
                    look = {"color": methods.colour(row.estimator)}
                    if low is not None and high is not None:
                        axis.plot([low, high], [place + shift] * 2, linewidth=1.6, **look)
                    label = methods.label(row.estimator) if place == 0 else None
                    axis.plot(middle, place + shift, "o", markersize=4.0, label=label, **look)
            axis.axhline(0.5, color="#444444", linewidth=0.8)
            axis.set_title(title, fontsize=10)
            axis.grid(axis="y", visible=False)
        axes[0].set_yticks(range(len(result.found)), [found.reading for found in result.found])
        axes[0].set_ylim(len(result.found) - 0.5, -0.5)
        for axis, (_, scale) in zip(axes, _PANELS.values(), strict=True):
            axis.set_xlim(left=-2.0 if scale == 100.0 else 0.0)
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=len(estimators))
        figure.suptitle(
            f"One reading of the paper changed at a time: {result.trials} trials of {result.robots} point masses, seed "
            f"{result.seed}; 95 % intervals but of arrival",
            fontsize=11,
        )
    return figure


def _interval(row: CaseRow, metric: str) -> tuple[float | None, float | None, float | None]:
    """Returns the value of a measure and where it is from and to."""
    if metric == "arrival_s":
        mean, sd = row.arrival_s.mean, row.arrival_s.sd
        return (mean, None, None) if mean is None or sd is None else (mean, mean - sd, mean + sd)
    found = getattr(row, metric)
    return value(row, metric), found.low, found.high
