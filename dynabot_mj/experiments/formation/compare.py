"""The main question: does the answer of the point-mass study survive rigid, skidding vehicles?

From the Dataset of a study to rows with intervals, and to tests on the same trials between estimators, plants and
perceptions. `compare_tables` tells them to readers.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import xarray as xr

from dynabot_mj.experiments.formation import case_rows, paired_tests
from dynabot_mj.experiments.formation.case_rows import CaseRow
from dynabot_mj.experiments.formation.paired_tests import Equivalence, Interaction, Paired

_MOST_LATE = 0.05  # share of trials that may not arrive without a word


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """What a study says."""

    study: xr.Dataset
    rows: Sequence[CaseRow]
    paired: Sequence[Paired]
    interactions: Sequence[Interaction]
    equivalences: Sequence[Equivalence]


def compared(study: xr.Dataset) -> Comparison:
    """Summarises and tests a study's cases.

    Args:
        study: Of `run` or `load`: cases x trials.

    Returns:
        A row for each case (`rows`), tests on the same trials (`paired`), and what follows from several of them.

    Example:
        >>> setup = dy.build_scenario({"trials": 2, "duration": 1.0, "plants": ["particle"], "estimators": ["gps"]})
        >>> comparison = dy.compare(dy.run(setup))
        >>> [row.label for row in comparison.rows]
        ['particle/gauss-markov/gps']
    """
    return Comparison(
        study=study,
        rows=case_rows.rows(study),
        paired=paired_tests.paired(study),
        interactions=paired_tests.interactions(study),
        equivalences=paired_tests.equivalences(study),
    )


def document(comparison: Comparison) -> dict[str, Any]:
    """Returns the JSON document of `dynabot compare`, but for the time that it took."""
    return {
        "rows": [case_rows.document(row) for row in comparison.rows],
        **{
            name: [asdict(one) for one in getattr(comparison, name)]
            for name in ("paired", "interactions", "equivalences")
        },
    }


def late(comparison: Comparison) -> str | None:
    """Returns one line about the cases of which more than 5 % of the trials did not arrive, if there are any."""
    found = [
        f"{100.0 * share.rate:.0f} % of {row.label}"
        for row in comparison.rows
        if (share := row.measured["arrival_s"].not_arrived).rate is not None and share.rate > _MOST_LATE
    ]
    if not found:
        return None
    duration = comparison.study.attrs["duration"]
    return f"not arrived within {duration:g} s: {', '.join(found)}; a longer --duration would tell more of them"
