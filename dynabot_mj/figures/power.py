"""The figure of `dynabot power`: what more trials find."""

from typing import Any

import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dynabot_mj.experiments.formation import power_report
from dynabot_mj.experiments.formation.power import Plan
from dynabot_mj.figures.style import STYLE

_COLOUR = "#0072B2"
_TARGET = "#D55E00"


def power(plan: Plan) -> Figure:
    """Draws the power against the number of trials, what is asked for, and where that is reached."""
    trials = [point.trials for point in plan.curve]
    with plt.rc_context(STYLE):
        figure, axis = plt.subplots(figsize=(7.0, 4.6), layout="constrained")
        axis.plot(trials, [point.power for point in plan.curve], ".-", markersize=4.0, color=_COLOUR, label=_told(plan))
        low, high = ([getattr(point, end) for point in plan.curve] for end in ("low", "high"))
        if None not in (*low, *high):
            axis.fill_between(trials, low, high, color=_COLOUR, alpha=0.2, linewidth=0.0, label="95 % interval")
        axis.axhline(plan.request.power, color=_TARGET, linewidth=1.0, label=power_report.target(plan))
        need = plan.needs[0]
        if need.trials is not None:
            axis.axvline(need.trials, color=_TARGET, linewidth=1.0, linestyle="--", label=f"{need.trials} trials")
        _ends(axis, plan)
        axis.set_xlim(trials[0], trials[-1])
        axis.set_ylim(0.0, 1.02)
        axis.set_xlabel("trials of each case")
        axis.set_ylabel("power")
        figure.legend(loc="outside lower center", ncols=2)
        figure.suptitle(f"{plan.measure.title}: {plan.request.a}\nminus {plan.request.b}", fontsize=11)
    return figure


def _told(plan: Plan) -> str:
    """Returns what difference the curve is of."""
    need = plan.needs[0]
    own = ", the pilot's own" if need.origin == "pilot" else ""
    return f"a - b of {power_report.signed(plan, need.difference)} {plan.measure.unit}{own}"


def _ends(axis: Axes, plan: Plan) -> None:
    """Draws the numbers of trials that the ends of the pilot's interval need, as far as they are in view."""
    ends = [one for one in plan.needs if one.origin in ("low", "high")]
    if not ends:
        return
    edge = plan.curve[-1].trials  # beyond it, or where there is no number
    needed = sorted(edge if one.trials is None else min(one.trials, edge) for one in ends)
    look: dict[str, Any] = {"color": _TARGET, "linewidth": 6.0, "alpha": 0.35, "solid_capstyle": "butt"}
    axis.plot(needed, [plan.request.power] * 2, **look, label="at the ends of its interval")
