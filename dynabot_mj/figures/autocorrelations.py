"""How large the errors of what robots believe are in the loop, and how long they last."""

import math

import matplotlib.pyplot as plt
import xarray as xr
from matplotlib.figure import Figure

from dynabot_mj.common.legend import (
    PERCEPTION_COLOURS,
    PERCEPTION_NAMES,
)
from dynabot_mj.figures.style import STYLE
from dynabot_mj.perception import methods
from dynabot_mj.plants.kinds import KINDS


def errors(study: xr.Dataset) -> Figure | None:
    """Draws how large the errors of the robots' positions are in the loop, and how long they last.

    Returns:
        A panel for each estimator; None where the study has no errors.
    """
    cases = [study.isel(case=index) for index in range(study.sizes["case"])]
    cases = [case for case in cases if float(case.position_autocovariance.isel(lag=0).mean()) > 0.0]
    if not cases:
        return None
    estimators = list(dict.fromkeys(str(case.estimator.item()) for case in cases))
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            1,
            len(estimators),
            figsize=(1.2 + 3.6 * len(estimators), 4.2),
            sharey=True,
            squeeze=False,
            layout="constrained",
        )
        for axis, estimator in zip(axes[0], estimators, strict=True):
            for case in (case for case in cases if case.estimator == estimator):
                perception, kind = str(case.perception.item()), KINDS[str(case.plant.item())]
                covariance = case.position_autocovariance.mean("trial").values
                axis.plot(
                    case.error_lag.values,
                    covariance / covariance[0],
                    linestyle=kind.line,
                    marker="o",
                    markersize=3.5,
                    fillstyle="full" if kind.body else "none",
                    color=PERCEPTION_COLOURS[perception],
                    label=f"{PERCEPTION_NAMES[perception]}, {kind.label}: {math.sqrt(covariance[0]):.2f} m",
                )
            axis.set_xscale("symlog", linthresh=0.05, linscale=0.3)
            axis.set_xlim(0.0, 40.0)
            axis.set_xticks([0.0, 0.1, 1.0, 10.0], ["0", "0.1", "1", "10"])
            axis.axhline(0.0, color="#888888", linewidth=0.8)
            axis.set_title(methods.label(estimator))
            axis.set_xlabel("lag [s]")
            axis.legend(fontsize=7.5, loc="upper center", bbox_to_anchor=(0.5, -0.16), handlelength=3.5)
        axes[0, 0].set_ylabel("autocorrelation of the position error")
        trials, seed = study.sizes["trial"], study.attrs["seed"]
        figure.suptitle(
            f"What robots believe of their position in the loop, and its root mean square per axis; {trials} trials, "
            f"seed {seed}",
            fontsize=11,
        )
    return figure
