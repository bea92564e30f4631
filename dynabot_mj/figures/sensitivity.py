"""The figure of `dynabot compare --sensitivity`: what each reading of the paper changes."""

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from dynabot_mj.experiments.formation import measures, summaries
from dynabot_mj.experiments.formation.sensitivity import Sensitivity
from dynabot_mj.figures.style import STYLE
from dynabot_mj.perception import methods


def sensitivity(result: Sensitivity) -> Figure:
    """Draws each measure over the readings, one mark and interval for each estimator."""
    estimators = list(dict.fromkeys(row.estimator for row in result.found[0].rows))
    told = measures.panels("sensitivity")
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            1, len(told), figsize=(2.75 * len(told), 1.6 + 0.3 * len(result.found)), sharey=True, layout="constrained"
        )
        for axis, (measure, title) in zip(axes, told, strict=True):
            for place, found in enumerate(result.found):
                for row in found.rows:
                    shift = 0.22 * (estimators.index(row.estimator) - (len(estimators) - 1) / 2.0)
                    middle, low, high = (
                        None if x is None else measure.scale * x for x in summaries.span(row.measured[measure.name])
                    )
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
        for axis, (measure, _) in zip(axes, told, strict=True):
            axis.set_xlim(left=-2.0 if measure.scale == 100.0 else 0.0)
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=len(estimators))
        figure.suptitle(
            f"One reading of the paper changed at a time: {result.trials} trials of {result.robots} point masses, seed "
            f"{result.seed}; 95 % intervals but of arrival",
            fontsize=11,
        )
    return figure
