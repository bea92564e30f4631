"""How wrong the robots of a study were about themselves, and surrogates that err alike.

The errors of a filter depend on the loop that it is in, so their statistics are taken there: from the autocovariances
that a study keeps of each trial (`dynabot_mj.perception.error_statistics`), averaged over its trials.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import tomli_w
import xarray as xr

from dynabot_mj.common.tables import Table
from dynabot_mj.estimation.gauss_markov import Component
from dynabot_mj.perception import error_statistics


@dataclass(frozen=True, kw_only=True)
class GaussMarkov:
    """A Gauss-Markov sequence, one of those whose sum has an error's autocovariance."""

    deviation: float  # in the error's unit
    time_s: float


@dataclass(frozen=True, kw_only=True)
class EstimateError:
    """Errors in the loop, over all trials, robots and axes; None where there was none to measure."""

    position_rms_m: float  # per axis
    velocity_rms_mps: float  # per axis
    heading_rms_deg: float | None  # of the heading that local laws use
    stale: float  # share of the samples without a fresh belief
    restarts: int  # of estimators that broke down
    position: tuple[GaussMarkov, ...]  # [m]
    velocity: tuple[GaussMarkov, ...]  # [m/s]
    heading: tuple[GaussMarkov, ...]  # [rad]


def errors(case: xr.Dataset) -> EstimateError | None:
    """Returns the errors of a case; None where robots know their state, or had no common clock to tell by."""
    position, velocity, heading = (
        case[f"{name}_autocovariance"].mean("trial").values for name in ("position", "velocity", "heading")
    )
    if not position[0] > 0.0:
        return None
    lag = case.error_lag.values
    return EstimateError(
        position_rms_m=math.sqrt(position[0]),
        velocity_rms_mps=math.sqrt(velocity[0]),
        heading_rms_deg=math.degrees(math.sqrt(heading[0])) if np.isfinite(heading[0]) else None,
        stale=float(case.stale.mean()),
        restarts=int(case.restarts.sum()),
        position=_sequences(error_statistics.components(lag, position)),
        velocity=_sequences(error_statistics.components(lag, velocity)),
        heading=_sequences(error_statistics.components(lag, heading)),
    )


def fitted_toml(study: xr.Dataset) -> str | None:
    """Returns the `[fitted]` table that imitates a study's filters; None where it has none.

    Errors are of the first plant that each estimator was run on.
    """
    found: dict[str, Any] = {}
    for index in range(study.sizes["case"]):
        case = study.isel(case=index)
        if str(case.perception.item()) != "filter" or str(case.estimator.item()) in found:
            continue
        measured = errors(case)
        if measured is not None:
            parts = {"position": measured.position, "velocity": measured.velocity, "heading": measured.heading}
            found[str(case.estimator.item())] = {
                name: [{"deviation": _digits(one.deviation), "time": _digits(one.time_s)} for one in part]
                for name, part in parts.items()
            }
    return tomli_w.dumps({"fitted": {"seed": int(study.attrs["seed"]), **found}}) if found else None


def table(study: xr.Dataset) -> Table | None:
    """Returns the errors of all cases as a table; None where no case has any."""
    body = []
    for index in range(study.sizes["case"]):
        case = study.isel(case=index)
        measured = errors(case)
        if measured is not None:
            heading = "-" if measured.heading_rms_deg is None else f"{measured.heading_rms_deg:.1f}"
            body.append(
                [
                    *(str(case[name].item()) for name in ("estimator", "plant", "perception")),
                    f"{measured.position_rms_m:.2f}",
                    _text(measured.position),
                    f"{measured.velocity_rms_mps:.3f}",
                    _text(measured.velocity),
                    heading,
                    f"{100.0 * measured.stale:.1f}",
                    str(measured.restarts),
                ]
            )
    if not body:
        return None
    header = ["estimator", "plant", "perception", "position [m]", "as σ [m] / τ [s]"]
    header += ["velocity [m/s]", "as σ [m/s] / τ [s]", "heading [°]", "stale [%]", "restarts"]
    return Table(title="Errors of the robots' beliefs in the loop", header=header, body=body, note=_NOTE)


_NOTE = """Root mean squares per axis; behind them the Gauss-Markov sequences whose sum has an autocovariance close to
theirs. Velocity: of the belief, whatever the dissipation uses. Heading: of the one that local laws use, where there are
any; ideal (-) with the gauss-markov surrogate. Stale: samples of robots without a fresh belief of their own."""


def _sequences(components: list[Component]) -> tuple[GaussMarkov, ...]:
    return tuple(GaussMarkov(deviation=one.deviation, time_s=one.time) for one in components)


def _digits(value: float) -> float:
    """Returns a value with the three digits that it means."""
    return float(f"{value:.3g}")


def _text(sequences: tuple[GaussMarkov, ...]) -> str:
    return " + ".join(f"{one.deviation:.2g} / {float(f'{one.time_s:.2g}'):g}" for one in sequences) or "-"
