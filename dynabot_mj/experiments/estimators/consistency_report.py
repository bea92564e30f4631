"""What `dynabot circle --consistency` reports: a JSON document and tables."""

from dataclasses import asdict
from typing import Any

from dynabot_mj.common import tables
from dynabot_mj.experiments.estimators.consistency import DURATION, SETTLED, ConsistencyOutcome
from dynabot_mj.experiments.estimators.consistency_bounds import CONFIDENCE, LAGS


def document(outcome: ConsistencyOutcome) -> dict[str, Any]:
    """Returns the JSON document."""
    labels = [{"sensors": case.sensors, "estimator": case.estimator} for case in outcome.cases]
    labelled = list(zip(labels, outcome.cases, strict=True))
    return {
        "seed": outcome.seed,
        "runs": outcome.runs,
        "confidence": CONFIDENCE,
        "squares": [
            {**label, **asdict(one), "verdict": one.verdict} for label, case in labelled for one in case.squares
        ],
        "whiteness": [
            {**label, **asdict(one), "lags": LAGS, "white": one.white}
            for label, case in labelled
            for one in case.whiteness
        ],
        "errors": [
            {**label, "position_m": case.position_m, "heading_deg": case.heading_deg} for label, case in labelled
        ],
        "too_small": [
            {
                **label,
                "states": case.too_small("NEES"),
                "innovations": case.too_small("NIS"),
                "coloured": case.coloured,
            }
            for label, case in labelled
        ],
    }


def markdown(outcome: ConsistencyOutcome) -> str:
    """Returns the tables."""
    squares, whiteness, summary = [], [], []
    for case in outcome.cases:
        label = [case.sensors, case.estimator]
        for square in case.squares:
            row = [f"{square.kind} {square.of}", f"{square.components}", f"{square.mean:.2f}"]
            row += [f"{square.low:.2f} to {square.high:.2f}", f"{100.0 * square.inside:.1f}", square.verdict]
            squares.append(label + row)
        for one in case.whiteness:
            row = [one.of, f"{one.largest:.3f} at {one.lag}", f"{one.bound_of_all:.3f}"]
            row += [f"{one.outside} of {LAGS * one.components}", "white" if one.white else "coloured"]
            whiteness.append(label + row)
        deceived = (case.too_small("NEES"), case.too_small("NIS"), case.coloured)
        row = [f"{case.position_m:.3f}", f"{case.heading_deg:.2f}", *("; ".join(names) or "-" for names in deceived)]
        summary.append(label + row)
    lines = [
        f"# Consistency of the filters, {outcome.runs} runs on the circle, seed {outcome.seed}",
        "",
        "RMS errors, per axis; whose covariance is too small, and what a filter could have told it by, not knowing the",
        "truth:",
        "",
        *tables.aligned([*_CASE, "position [m]", "heading [deg]", "too small", "NIS too large", "not white"], summary),
        "",
        f"Means over runs and times from {SETTLED:g} s to {DURATION:g} s, beside the {100.0 * CONFIDENCE:g} % bounds",
        "that a consistent filter's mean lies in; `inside`: the share of the times [%] at which the mean over the runs",
        "lies in its own chi-square bounds, 99 in a consistent filter. The last column judges the covariance.",
        "",
        *tables.aligned([*_CASE, "square", "components", "mean", "bounds", "inside", "covariance"], squares),
        "",
        f"Autocorrelation of the innovations at lags 1 to {LAGS}: the largest of all components and its bound; how",
        "many lie outside the bound of a single one (1 % would by chance).",
        "",
        *tables.aligned([*_CASE, "innovation", "largest", "bound", "outside", ""], whiteness),
    ]
    return "\n".join(lines) + "\n"


_CASE = ("sensors", "filter")
