"""A comparison as readable tables: by the measures that hold, by the paper's own, and its tests."""

import itertools
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import replace

import xarray as xr

from dynabot_mj.common import tables
from dynabot_mj.common.tables import Table
from dynabot_mj.experiments.formation import cells, compare, in_loop, measures, paired_tests
from dynabot_mj.experiments.formation.compare import Comparison
from dynabot_mj.experiments.formation.measure import Factor
from dynabot_mj.experiments.formation.measures import MEASURES, PAIRED, TESTED
from dynabot_mj.experiments.formation.paired_tests import Equivalence, Interaction, Paired
from dynabot_mj.formation import laws
from dynabot_mj.study import configuration
from dynabot_mj.testbed.paper import ROBOTS, TABLE_III, TableIIIRow

ALPHA = 0.05  # below which an adjusted p value is told as a difference
_MEASURE = {one.name: one for one in PAIRED}


def markdown(comparison: Comparison) -> str:
    """Returns all tables of a comparison, as `dynabot compare` prints them.

    Args:
        comparison: Of `compared`.

    Example:
        >>> setup = dy.build_scenario({"trials": 2, "duration": 1.0, "plants": ["particle"], "estimators": ["gps"]})
        >>> text = dy.comparison_markdown(dy.compare(dy.run(setup)))
        >>> text.splitlines()[0]
        '# Formation of 3 robots, 2 trials of 1 s, seed 0'
    """
    errors = in_loop.table(comparison.study)
    others = [reproduction(comparison), *tests(comparison), *([errors] if errors else [])]
    return "\n\n".join([table(comparison).markdown(level=1), *(one.markdown() for one in others)]) + "\n"


def title(study: xr.Dataset) -> str:
    """Returns what a study is of."""
    robots, trials = study.sizes["robot"], study.sizes["trial"]
    count = f"{trials} trials" if trials > 1 else "1 trial"
    return f"Formation of {robots} robots, {count} of {study.attrs['duration']:g} s, seed {study.attrs['seed']}"


def table(comparison: Comparison) -> Table:
    """Returns the cases by the measures that do not depend on the length of the run."""
    shown = measures.columns("cases")
    body = []
    for estimator, group in itertools.groupby(comparison.rows, lambda one: one.estimator):
        for index, row in enumerate(group):
            body.append(
                [
                    "" if index else estimator,
                    row.plant,
                    row.perception or "",
                    f"{row.sample_period_ms:g}, {row.period_ms:g}",
                    f"{row.alpha_h:g}, {row.alpha_d:g}",
                    *(column.text(row.measured[one.name]) for one, column in shown),
                    f"{'-' if row.overturned is None else row.overturned}, {row.diverged}",
                ]
            )
    note = _explained(dict.fromkeys([_NOTE, *(one.note for one, _ in shown)]))
    note = note.format(horizon=f"{comparison.study.attrs['duration']:g} s")
    header = ["estimator", "plant", "perception", "T_s, T_c [ms]", "gains"]
    return Table(
        title=title(comparison.study),
        header=[*header, *(column.header for _, column in shown), "overturned, diverged"],
        body=body,
        note="\n\n".join([note, *_remarks(comparison)]),
    )


def reproduction(comparison: Comparison) -> Table:
    """Returns the paper's own measures beside its Table III."""
    robots = comparison.study.sizes["robot"]
    # The paper has results for three robots only; beside another fleet they are a point of reference.
    paper = "paper" if robots == ROBOTS else f"paper, {ROBOTS} robots"
    shown = [one for one in MEASURES if one.paper_columns]
    body = []
    for estimator, group in itertools.groupby(comparison.rows, lambda one: one.estimator):
        published = TABLE_III.get(estimator)
        if published is not None:
            body.append([estimator, paper, "", *_published(published)])
        for index, row in enumerate(group):
            body.append(
                [
                    estimator if published is None and index == 0 else "",
                    row.plant,
                    row.perception or "",
                    f"{row.period_ms:g}",
                    f"{row.alpha_h:g}, {row.alpha_d:g}",
                    *(column.text(row.measured[one.name], published) for one in shown for column in one.paper_columns),
                ]
            )
    header = ["estimator", "plant", "perception", "T_c [ms]", "gains"]
    return Table(
        title="The paper's own measures, beside its Table III",
        header=[*header, *(column.header for one in shown for column in one.paper_columns)],
        body=body,
        note=_explained([*(one.note for one in shown), _PAPER_NOTE]),
    )


def tests(comparison: Comparison) -> list[Table]:
    """Returns the tests between estimators, plants and perceptions, their interactions, and equivalence."""
    found = []
    for factor, name in _TITLES.items():
        if chosen := paired_tests.of_factor(comparison.paired, factor):
            labels = ["plant, perception" if factor == "estimator" else "estimator", "difference"]
            found.append(_tests(name, labels, [(_compared(one), one) for one in chosen], ""))
    found = [*found[:-1], *(replace(last, note=_TEST_NOTE) for last in found[-1:])]
    if comparison.interactions:
        labels = ["estimator", "difference of particle - rigid"]
        told = [((one.estimator, f"{one.a} - {one.b}"), one) for one in comparison.interactions]
        found.append(_tests("Does the body matter more with one perception?", labels, told, _INTERACTION_NOTE))
    if comparison.equivalences:
        found.append(_equivalence(comparison))
    return found


_TITLES: dict[Factor, str] = {
    "estimator": "Between estimators, on the same trials",
    "plant": "Between plants, on the same trials",
    "perception": "Between perceptions, on the same trials",
}

_NOTE = "Rates in % with 95 % Wilson intervals."
_PAPER_NOTE = "Runs shorter than 13 s have none of them (-)."

_TEST_NOTE = """\
Mean paired differences: 95 % BCa intervals and permutation tests; rates in percentage points, with score intervals and
McNemar's exact test. p is Holm's, over all tests of this table; * below 0.05. Arrival (n): over the n trials that
arrived in both cases, which in band is of too. A mean's interval of no width means that all pairs are equal. Medians of
times of which some are beyond the duration are as open (...) as that leaves them."""

_INTERACTION_NOTE = """\
Particle less rigid with one perception, less the same with another, on the same trials: 95 % BCa intervals and
permutation tests, p by Holm over this table; * below 0.05."""

_EQUIVALENCE_NOTE = """\
Filter less fitted, on the same trials, with 90 % intervals: equivalent (two one-sided tests at 5 %) where the interval
lies within the margin, which was stated before; nothing is said (-) of fewer than 10 pairs, of pairs that are all
alike, or where most do not form. The surrogate was fitted on seed {fitted}{verdict}."""


def _remarks(comparison: Comparison) -> list[str]:
    """Returns what has to be said of a study's own choices."""
    study, rows = comparison.study, comparison.rows
    sources = {one.perception or "perfect": one.velocity for one in rows}
    told = ", ".join(f"{source} ({perception})" for perception, source in sources.items())
    remarks = [f"Velocity of the dissipation: {told}."]
    controller = study.attrs.get("controller", laws.BUILT_IN)  # older studies do not say
    if controller != laws.BUILT_IN:
        remarks.append(f"Controller: {controller}, in place of the paper's potential field; its gains are not used.")
    setup = configuration.load(study.attrs["configuration"], "the study's configuration")
    if setup.vehicle.slope != 0.0 and len(setup.plants) > 1:
        remarks.append(f"Bodies drive on a slope of {setup.vehicle.slope:g}; point masses know no ground.")
    if line := compare.late(comparison):
        remarks.append(f"{line[0].upper()}{line[1:]}.")
    return remarks


def _explained(parts: Iterable[str]) -> str:
    """Returns a paragraph of what explains a table, in lines of 120 columns."""
    return textwrap.fill(" ".join(part for part in parts if part), 120)


def _published(row: TableIIIRow) -> list[str]:
    """Returns the cells of a row of Table III, with its own period and gains."""
    found = [f"{1e3 * row.period:g}", f"{row.alpha_h:g}, {row.alpha_d:g}"]
    for one in MEASURES:
        if one.paper_columns:
            value = cells.published(one.published(row)) if one.published else ""
            found += [value, *[""] * (len(one.paper_columns) - 1)]
    return found


def _tests(
    name: str, labels: Sequence[str], told: Iterable[tuple[tuple[str, str], Paired | Interaction]], note: str
) -> Table:
    """Returns a table with a row for each label and a column for each measure."""
    body: dict[tuple[str, str], dict[str, str]] = {}
    for label, one in told:
        body.setdefault(label, {})[one.metric] = _cell(one)
    return Table(
        title=name,
        header=[*labels, *(f"{one.title} (n)" if one.counted else one.title for one in TESTED)],
        body=[[*label, *(texts[one.name] for one in TESTED)] for label, texts in body.items()],
        note=note,
    )


def _compared(one: Paired) -> tuple[str, str]:
    """Returns what two cases have in common, and what differs."""
    (a, estimator), (b, other) = one.a.rsplit("/", 1), one.b.rsplit("/", 1)
    return (a, f"{estimator} - {other}") if one.factor == "estimator" else (estimator, f"{a} - {b}")


def _cell(one: Paired | Interaction) -> str:
    text, measure = _difference(one), _MEASURE[one.metric]
    if measure.counted and one.difference is not None:
        text += f" ({one.n})"
    if measure.censored and one.median is not None:
        middle = tables.median(one.median, sign="+")
        text += f", median {middle}" if middle != "-" else ""
    if one.p_holm is None:
        return text
    p = "p < .001" if one.p_holm < 0.001 else f"p {one.p_holm:.3f}".replace("0.", ".", 1)
    return f"{text} {p}" + " *" * (one.p_holm < ALPHA)


def _difference(one: Paired | Interaction | Equivalence) -> str:
    measure = _MEASURE[one.metric]
    scale, digits = measure.scale, measure.digits
    if one.difference is None:
        return "-"
    text = f"{scale * one.difference:+.{digits}f}"
    if one.low is not None and one.high is not None:
        text += f" [{scale * one.low:+.{digits}f}, {scale * one.high:+.{digits}f}]"
    return text


def _equivalence(comparison: Comparison) -> Table:
    margins = {one.metric: one.margin for one in comparison.equivalences}
    said = {True: " equivalent", False: " not shown", None: " -"}
    body: dict[tuple[str, str], list[str]] = {}
    for one in comparison.equivalences:
        body.setdefault((one.estimator, one.plant), []).append(_difference(one) + said[one.equivalent])
    setup = configuration.load(comparison.study.attrs["configuration"], "the study's configuration")
    own = setup.fitted.seed == setup.seed
    verdict = ", this very one: judge it on another" if own else f", and is judged on seed {setup.seed}"
    headings = [f"{_MEASURE[name].title} ± {_MEASURE[name].scale * margin:g}" for name, margin in margins.items()]
    return Table(
        title="Is the fitted surrogate as good as the filters?",
        header=["estimator", "plant", *headings],
        body=[[*label, *cells] for label, cells in body.items()],
        note=_EQUIVALENCE_NOTE.format(fitted=setup.fitted.seed, verdict=verdict),
    )
