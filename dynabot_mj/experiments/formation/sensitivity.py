"""Which conclusions survive the readings of the paper that are ours: one changed at a time, on point masses.

The paper leaves open what the scenario marks "ours". Each reading is the whole study with one of them changed, on the
same trials; what is asked of it is what a study concludes: arrival, time to formation, contacts, formations within a
metre, and the order of the estimators by each, told as different only where Holm's adjustment allows.
"""

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import xarray as xr

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.common.tables import Table
from dynabot_mj.experiments.formation import case_rows, measures, paired_tests, summaries
from dynabot_mj.experiments.formation.case_rows import CaseRow
from dynabot_mj.experiments.formation.measures import MEASURES
from dynabot_mj.experiments.formation.paired_tests import Paired
from dynabot_mj.study import scenario
from dynabot_mj.study.scenario import Scenario
from dynabot_mj.testbed.paper import UTILISATION_TABLE_I

Run = Callable[[str, Scenario], xr.Dataset]

ESTIMATORS: tuple[str, ...] = ("gps", "decoupled", "coupled")
ALPHA = 0.05
RANKED = {one.name: one.ranking for one in MEASURES if one.ranking is not None}  # by which estimators are ordered


@dataclass(frozen=True, kw_only=True)
class Reading:
    """One reading of the paper changed."""

    name: str
    changed: Callable[[Scenario], Scenario]


@dataclass(frozen=True, kw_only=True)
class Found:
    """What a study says with it."""

    reading: str
    duration_s: float
    rows: Sequence[CaseRow]
    ranking: Mapping[str, str]  # by each of `RANKED`, best first, see `ranking`


@dataclass(frozen=True, kw_only=True)
class Sensitivity:
    """All readings, the unchanged one first."""

    trials: int
    robots: int
    seed: int
    found: Sequence[Found]


def _field(**values: Any) -> Callable[[Scenario], Scenario]:
    return lambda setup: replace(setup, field=replace(setup.field, **values))


def _surrogate(**values: Any) -> Callable[[Scenario], Scenario]:
    return lambda setup: replace(setup, surrogate=replace(setup.surrogate, **values))


def _methods(**values: Any) -> Callable[[Scenario], Scenario]:
    def changed(setup: Scenario) -> Scenario:
        rows = {name: replace(scenario.method(setup, name), **values) for name in ESTIMATORS}
        return replace(setup, method={**setup.method, **rows})

    return changed


def _top(**values: Any) -> Callable[[Scenario], Scenario]:
    return lambda setup: replace(setup, **values)


def readings(setup: Scenario) -> tuple[Reading, ...]:
    """Returns the readings of a configuration, the configuration itself first."""
    dissipation = setup.field.dissipation
    return (
        Reading(name="as it is", changed=lambda setup: setup),
        *(Reading(name=f"tau {tau:g} s", changed=_surrogate(correlation_time=tau)) for tau in (0.04, 0.16, 0.3)),
        Reading(name="sigma per axis", changed=_surrogate(sigma="per-axis")),
        *(
            Reading(name=f"c {100.0 * share:+.0f} %", changed=_field(dissipation=(1.0 + share) * dissipation))
            for share in (-0.2, 0.2)
        ),
        *(Reading(name=f"F_max {limit:g} N", changed=_methods(force_limit=limit)) for limit in (25.0, 100.0)),
        *(Reading(name=f"mass {mass:g} kg", changed=_top(mass=mass)) for mass in (8.0, 16.0)),
        *(Reading(name=f"d_l {reach:g} m", changed=_field(neighbour_range=reach)) for reach in (7.5, 15.0)),
        *(
            Reading(name=f"messages of {count} bytes", changed=_top(radio=replace(setup.radio, message_bytes=count)))
            for count in (1, 125)
        ),
        Reading(
            name=f"U {UTILISATION_TABLE_I:g}",
            changed=_top(processor=replace(setup.processor, utilisation=UTILISATION_TABLE_I)),
        ),
        Reading(
            name="polygon by largest error", changed=_top(completion=replace(setup.completion, fit="largest-error"))
        ),
        *(Reading(name=f"duration {time:g} s", changed=_top(duration=time)) for time in (120.0, 160.0)),
        Reading(name="gains 650, 300 for all", changed=_methods(alpha_h=650.0, alpha_d=300.0)),
    )


def prepared(setup: Scenario) -> Scenario:
    """Returns what a sensitivity study is of.

    Raises:
        InputError: If it is asked of something else than point masses with the paper's error.
    """
    defaults = Scenario()
    for name, allowed in (("plants", ("particle",)), ("perception", ("gauss-markov",))):
        given = getattr(setup, name)
        if given not in (allowed, getattr(defaults, name)):
            raise InputError(
                f"{name} = {', '.join(given)} given with --sensitivity, which is of {allowed[0]} alone: its readings "
                "are of the point-mass study"
            )
    if setup.estimators not in (defaults.estimators, tuple(one for one in setup.estimators if one in ESTIMATORS)):
        raise InputError(
            f"estimators = {', '.join(setup.estimators)} given with --sensitivity, allowed are {', '.join(ESTIMATORS)}"
        )
    estimators = tuple(name for name in setup.estimators if name in ESTIMATORS)
    return replace(setup, plants=("particle",), estimators=estimators)


def examine(setup: Scenario, run: Run) -> Sensitivity:
    """Runs all readings.

    Args:
        setup: Of `prepared`.
        run: Runs a study of a name and a configuration.
    """
    found = []
    for reading in readings(setup):
        study = run(reading.name, reading.changed(setup))
        rows = case_rows.rows(study)
        differences = paired_tests.of_factor(paired_tests.paired(study), "estimator")
        found.append(
            Found(
                reading=reading.name,
                duration_s=float(study.attrs["duration"]),
                rows=rows,
                ranking={name: ranking(name, rows, differences) for name in RANKED},
            )
        )
    return Sensitivity(trials=setup.trials, robots=setup.robots, seed=setup.seed, found=tuple(found))


def value(row: CaseRow, metric: str) -> float | None:
    """Returns what a row says by a measure."""
    return summaries.span(row.measured[metric])[0]


def ranking(metric: str, rows: Sequence[CaseRow], differences: Sequence[Paired]) -> str:
    """Returns the estimators in their order by a measure, best first.

    `<` stands where each one before differs from each one after, on the same trials and in the order of the means; what
    is joined by `~` cannot all be told apart.

    Args:
        metric: One of `RANKED`.
        rows: One of each estimator.
        differences: Between the estimators.
    """
    sign = -1.0 if RANKED[metric].better == "higher" else 1.0
    cost = {row.estimator: sign * mean for row in rows if (mean := value(row, metric)) is not None}
    known = sorted(cost, key=lambda name: cost[name])
    better = set()  # (which, than which)
    for one in differences:
        if one.metric == metric and one.difference and one.p_holm is not None and one.p_holm < ALPHA:
            a, b = (label.rsplit("/", 1)[1] for label in (one.a, one.b))
            better.add((a, b) if sign * one.difference < 0.0 else (b, a))
    groups: list[list[str]] = [[]]
    for place, name in enumerate(known):
        if place and all(pair in better for pair in itertools.product(known[:place], known[place:])):
            groups.append([])
        groups[-1].append(name)
    # What cannot be told apart stands in one order always.
    return " < ".join(" ~ ".join(sorted(names, key=ESTIMATORS.index)) for names in groups) or "-"


def document(result: Sensitivity) -> dict[str, Any]:
    """Returns the JSON document."""
    return {
        "trials": result.trials,
        "robots": result.robots,
        "seed": result.seed,
        "readings": [
            {
                "reading": one.reading,
                "duration_s": one.duration_s,
                "ranking": dict(one.ranking),
                "rows": [case_rows.document(row) for row in one.rows],
            }
            for one in result.found
        ],
    }


def markdown(result: Sensitivity) -> str:
    """Returns the tables: the measures of each reading, and the order of the estimators."""
    body, orders, base = [], [], result.found[0]
    shown = measures.columns("readings")
    for one in result.found:
        for index, row in enumerate(one.rows):
            told = (column.text(row.measured[measure.name]) for measure, column in shown)
            body.append(["" if index else one.reading, row.estimator, *told])
        cells = [one.ranking[name] + ("" if one.ranking[name] == base.ranking[name] else " (!)") for name in RANKED]
        orders.append([one.reading, *cells])
    count = f"{result.trials} trials of {result.robots} point masses, seed {result.seed}"
    header = ["reading", "estimator", *(column.header for _, column in shown)]
    values = Table(title=f"Sensitivity to the readings of the paper, {count}", header=header, body=body, note=_NOTE)
    ranks = Table(
        title="The order of the estimators, best first",
        header=["reading", *(one.title for one in RANKED.values())],
        body=orders,
        note=_RANKING_NOTE,
    )
    return f"{values.markdown(level=1)}\n\n{ranks.markdown()}\n"


_NOTE = """\
One reading changed at a time, on the same trials. Arrival as mean ± sd; formation as a mean restricted to the duration,
with its 95 % BCa interval; rates in % with 95 % Wilson intervals. Own sigma: the paper's completion."""

_RANKING_NOTE = """\
`<`: each before differs from each after on the same trials, p below 0.05 by Holm over all tests of the reading; `~`:
they cannot all be told apart. (!): not as it is without a change."""
