"""What `dynabot circle` reports: Table II and more, as a JSON document and beside the paper's numbers."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from dynabot_mj.common import intervals, tables
from dynabot_mj.common.intervals import Mean, Rate
from dynabot_mj.common.tables import Table
from dynabot_mj.experiments.estimators import circle
from dynabot_mj.experiments.estimators.circle import CircleOutcome
from dynabot_mj.testbed import paper


@dataclass(frozen=True, kw_only=True)
class CircleRow:
    """One estimator: means over the runs in which it knew throughout where it was."""

    estimator: str
    uncertainty_m: Mean
    true_error_m: Mean
    nees: Mean | None  # None: it has no ten states
    nis: Mean
    rms_per_axis_m: Mean
    rms_mean_removed_m: Mean
    heading_rms_deg: Mean
    restarts: int  # in all runs
    paper_m: float | None  # None: the paper has no such path, or no such estimator


def rows(outcome: CircleOutcome) -> list[CircleRow]:
    """Returns one row for each estimator."""
    return [_row(outcome, name) for name in outcome.request.estimators]


def ordered(outcome: CircleOutcome) -> Rate:
    """Returns the share of the runs in which the uncertainty is gps > decoupled > coupled, where all have one."""
    gps, decoupled, coupled = (outcome.scores[name].uncertainty for name in ("gps", "decoupled", "coupled"))
    so = ((gps > decoupled) & (decoupled > coupled)).astype(np.float64)
    return intervals.rate(np.where(np.isfinite(gps + decoupled + coupled), so, np.nan))


def document(outcome: CircleOutcome) -> dict[str, Any]:
    """Returns the JSON document."""
    asked = outcome.request
    return {
        "runs": asked.runs,
        "seed": asked.seed,
        "plant": asked.plant,
        "path": asked.path,
        "duration_s": asked.duration,
        "period_ms": 1e3 * asked.period,
        "rows": [asdict(row) for row in rows(outcome)],
        "ordered_fraction": asdict(ordered(outcome)),
    }


def markdown(outcome: CircleOutcome) -> str:
    """Returns the outcome as a readable table."""
    return table(outcome).markdown(level=1) + "\n"


def table(outcome: CircleOutcome) -> Table:
    """Returns the outcome as a table beside the paper's."""
    asked = outcome.request
    header = ["estimator", "uncertainty [m]", "paper [m]", "true error [m]", "RMS [m]", "RMS, mean removed [m]"]
    header += ["heading RMS [deg]", "NEES", "NIS", "runs"]
    body = [
        [
            row.estimator,
            _mean(row.uncertainty_m),
            "-" if row.paper_m is None else f"{row.paper_m:g}",
            _mean(row.true_error_m),
            _mean(row.rms_per_axis_m),
            _mean(row.rms_mean_removed_m),
            _mean(row.heading_rms_deg),
            "-" if row.nees is None else _mean(row.nees),
            _mean(row.nis),
            str(row.uncertainty_m.n),
        ]
        for row in rows(outcome)
    ]
    return Table(
        title=f"Estimators on the {asked.path}, {asked.plant} plant: {asked.runs} runs of {asked.duration:g} s, "
        f"T_s = {1e3 * asked.period:g} ms, seed {asked.seed}",
        header=header,
        body=body,
        note=f"Uncertainty gps > decoupled > coupled in {tables.rate(ordered(outcome))} % of the runs.\n\n{_NOTE}",
    )


_NOTE = f"""Mean ± sd over the runs, 95 % Wilson interval; of each run the first {circle.DROPPED:g} s are dropped.
Uncertainty: largest distance of the estimated path from the best-fit actual one (Table II of the paper).
True error: largest distance of an estimate from where the robot was. RMS is per axis. NEES and NIS of a
consistent filter are 10 and 4."""


def _row(outcome: CircleOutcome, name: str) -> CircleRow:
    scores, published = outcome.scores[name], paper.TABLE_II.get(name)
    return CircleRow(
        estimator=name,
        uncertainty_m=intervals.mean(scores.uncertainty),
        true_error_m=intervals.mean(scores.true_error),
        nees=intervals.mean(scores.nees) if np.isfinite(scores.nees).any() else None,
        nis=intervals.mean(scores.nis),
        rms_per_axis_m=intervals.mean(scores.rms),
        rms_mean_removed_m=intervals.mean(scores.rms_mean_removed),
        heading_rms_deg=intervals.mean(np.degrees(scores.heading_rms)),
        restarts=outcome.restarts[name],
        paper_m=published.uncertainty if published is not None and outcome.request.path == "circle" else None,
    )


def _mean(value: Mean) -> str:
    """Returns a mean as `mean ± sd` to the centimetre, or a dash."""
    if value.mean is None:
        return "-"
    return f"{value.mean:.2f}" + (f" ± {value.sd:.2f}" if value.sd is not None else "")
