"""What `dynabot circle --faults` reports: a JSON document and tables."""

import math
from dataclasses import asdict
from typing import Any

from dynabot_mj.common import tables
from dynabot_mj.experiments.estimators.crossings import NEAR, Crossing
from dynabot_mj.experiments.estimators.faults import BAND, RETURNED, WITHIN, Cost, FaultsOutcome


def document(outcome: FaultsOutcome) -> dict[str, Any]:
    """Returns the JSON document."""
    return {
        "seed": outcome.seed,
        "runs": outcome.runs,
        "faults": [asdict(one) for one in outcome.costs],
        "crossings": [asdict(one) for one in outcome.crossings],
    }


def markdown(outcome: FaultsOutcome) -> str:
    """Returns the tables."""
    header = ["fault", "estimator", "position [m]", "worst run", "excess [m]", "heading [deg]", "excess [deg]"]
    header += ["position back [s]", "heading back [s]"]
    beside = ["estimator", "crossings", "heading RMS [deg]", "largest [deg]", "position RMS [m]"]
    lines = [
        f"# Faults of sensors, {outcome.runs} runs on the circle, seed {outcome.seed}",
        "",
        f"From the beginning of the fault to {WITHIN:g} s after its end: the largest errors of a run, their mean over",
        "the runs, and by how much that exceeds the same runs without the fault (95 % bootstrap); after how long",
        f"{100.0 * RETURNED:g} % of the runs are back in the band of {100.0 * BAND:g} % of the unfaulted errors.",
        "",
        *tables.aligned(header, [_cost(one) for one in outcome.costs]),
        "",
        f"Estimates that were not finite: {_where(outcome, 'not_finite')}. Restarts: {_where(outcome, 'restarts')}.",
        "",
        f"Unfaulted errors within {math.degrees(NEAR):g} degrees of where the bearing jumps by 360, and elsewhere:",
        "",
        *tables.aligned(beside, [_crossing(one) for one in outcome.crossings]),
    ]
    return "\n".join(lines) + "\n"


def _cost(one: Cost) -> list[str]:
    return [
        one.fault,
        one.estimator,
        f"{one.position_m:.2f}",
        f"{one.worst_position_m:.2f}",
        tables.difference(one.excess_m, 2),
        f"{one.heading_deg:.1f}",
        f"{one.heading_deg - one.unfaulted_heading_deg:.1f}",
        _seconds(one.position_recovery_s),
        _seconds(one.heading_recovery_s),
    ]


def _crossing(one: Crossing) -> list[str]:
    return [
        one.estimator,
        f"{one.crossings}",
        f"{one.near_heading_deg:.2f}, {one.far_heading_deg:.2f}",
        f"{one.near_largest_heading_deg:.1f}, {one.far_largest_heading_deg:.1f}",
        f"{one.near_position_m:.2f}, {one.far_position_m:.2f}",
    ]


def _where(outcome: FaultsOutcome, count: str) -> str:
    """Returns what there should be none of, with its faults and estimators."""
    found = [(getattr(one, count), one) for one in outcome.costs]
    return "; ".join(f"{number} ({one.fault}, {one.estimator})" for number, one in found if number) or "none"


def _seconds(value: float | None) -> str:
    return f"> {WITHIN:g}" if value is None else f"{value:.1f}"
