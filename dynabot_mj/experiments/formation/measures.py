"""The table of measures that cases are told and compared by; `dynabot_mj.formation.metrics` defines them.

Whatever tells of cases is made from it: rows in JSON and CSV, tables and what explains them, panels of figures, tests
on the same trials, the order of estimators. To add a measure, add an entry; its place here is its place there.
"""

from typing import Any

from dynabot_mj.common import tables
from dynabot_mj.experiments.formation import cells, summaries, trial_values
from dynabot_mj.experiments.formation.measure import (
    Column,
    Factor,
    FigureName,
    Measure,
    PairedMeasure,
    PairedRate,
    PaperColumn,
    Ranking,
    TableName,
)

_WITHIN_A_PLANT: tuple[Factor, ...] = ("estimator", "perception")

MEASURES: tuple[Measure[Any], ...] = (
    PairedMeasure(
        name="arrival_s",
        summary=summaries.arrival,
        title="arrival [s]",
        values=trial_values.read("arrival"),
        counted=True,
        margin=1.0,
        columns=(
            Column(header="arrival [s]", text=tables.mean_and_sd, tables=("cases", "readings")),
            Column(header="not arrived", text=lambda one: tables.rate(one.not_arrived), tables=("cases", "readings")),
        ),
        note="Arrival: mean ± sd over the trials that arrived at the leader's well.",
        panels={
            "outcomes": "arrival [s], mean ± sd",
            "differences": "arrival [s]",
            "sensitivity": "arrival [s], mean ± sd",
        },
        ranking=Ranking(title="arrival", better="lower"),
    ),
    PairedMeasure(
        name="time_to_formation_s",
        summary=summaries.restricted("formation"),
        title="formation [s]",
        values=lambda case: trial_values.restricted(case, "formation"),
        digits=1,
        censored=True,
        margin=0.05,
        columns=(
            Column(header="formation [s]", text=tables.interval, tables=("cases", "readings")),
            Column(header="median", text=lambda one: tables.median(one.median)),
            Column(header="not formed", text=lambda one: tables.rate(one.without)),
        ),
        note="Formation: when the common band began to hold for 5 s, as a mean restricted to {horizon}, which counts "
        "for trials that did not form or touched before, with its 95 % BCa interval; and as a median with its exact "
        "one, since a few trials at the horizon make the mean's hold less often.",
        panels={
            "outcomes": "time to formation [s],\nmean restricted to {horizon}",
            "differences": "time to formation [s]",
            "sensitivity": "time to formation [s]",
        },
        ranking=Ranking(title="formation", better="lower"),
    ),
    PairedMeasure(
        name="in_band_fraction",
        summary=summaries.mean("in_band"),
        title="in band",
        values=trial_values.read("in_band"),
        scale=100.0,
        digits=0,
        margin=0.1,
        columns=(Column(header="in band [%]", text=lambda one: tables.mean_and_sd(one, 100.0, 0)),),
        note="In band: share of the time since arrival.",
        panels={"differences": "time in band [points]"},
    ),
    PairedMeasure(
        name="settling_s",
        summary=summaries.settling,
        title="settling [s]",
        values=trial_values.read("settling"),
        tested=False,
        paired_rank=4,
        paper_columns=(
            PaperColumn(header="settling [s]", text=lambda one, paper: tables.mean_and_sd(one)),
            PaperColumn(header="off [s.e.]", text=cells.off),
            PaperColumn(header="n", text=cells.settled),
            PaperColumn(header="unsettled", text=lambda one, paper: tables.rate(one.unsettled)),
        ),
        published=summaries.published_settling,
        note="Settling depends on the length of the run: it is measured against the trial's own end, and nothing is "
        "concluded from it. Its mean ± sd is over the n trials that settled and whose centres did not collide; behind "
        "n, how many of them had hulls overlap. Off: how far the mean is from the paper's, in standard errors of both, "
        "with 100 trials there.",
        panels={"table_iii": "settling time [s], mean ± sd"},
    ),
    PairedMeasure(
        name="restricted_settling_s",
        summary=summaries.restricted("settling"),
        title="settling, restricted [s]",
        values=lambda case: trial_values.restricted(case, "settling"),
        tested=False,
        paired_rank=5,
    ),
    PairedMeasure(
        name="top_speed_mps",
        summary=summaries.mean("top_speed"),
        title="top speed [m/s]",
        values=trial_values.read("top_speed"),
        tested=False,
        paired_rank=3,
        columns=(Column(header="top speed [m/s]", text=tables.mean_and_sd, rank=1),),
        panels={"differences": "top speed [m/s]"},
    ),
    PairedRate(
        name="collision",
        summary=summaries.collision_of_centres,
        title="collision of centres",
        values=trial_values.of_centres,
        factors=_WITHIN_A_PLANT,
        tested=False,
        paired_rank=2,
        paper_columns=(PaperColumn(header="collision", text=cells.rate_beside),),
        published=lambda row: summaries.published_rate(row.collision),
        note="Collision is of centres, nearer than 0.40 m: of point masses only, since bodies are larger.",
        panels={"table_iii": "collision of centres [%]"},
    ),
    PairedRate(
        name="collision_footprint",
        summary=summaries.rate("collision_footprint"),
        title="hulls",
        values=trial_values.read("collision_footprint"),
        margin=0.1,
        columns=(Column(header="hulls", text=tables.rate, tables=("cases", "readings")),),
        note="Hulls: footprints, which reach 1 cm beyond the hulls, overlap; per minute: first contacts after arrival "
        "over the time at risk, exact Poisson interval (in parentheses: trials left out, which touched before they "
        "arrived).",
        panels={
            "outcomes": "trials in which hulls\noverlap [%]",
            "differences": "hulls overlap [points]",
            "sensitivity": "hulls overlap [%]",
        },
        ranking=Ranking(title="hulls", better="lower"),
    ),
    Measure(
        name="collision_hulls_per_min",  # the note of the hulls explains it
        summary=summaries.contact_hazard,
        columns=(Column(header="hulls/min", text=cells.hazard),),
    ),
    Measure(name="hull_contact", summary=summaries.rate("hull_contact")),
    PairedRate(
        name="completion",
        summary=summaries.rate("completion"),
        title="completion, own σ",
        values=trial_values.read("completion"),
        factors=_WITHIN_A_PLANT,
        tested=False,  # each estimator is judged by another tolerance
        paired_rank=1,
        columns=(Column(header="own sigma", text=tables.rate, tables=("readings",), rank=1),),
        paper_columns=(PaperColumn(header="completion", text=cells.rate_beside),),
        published=lambda row: summaries.published_rate(row.completion),
        note="Completion is within each method's own sigma, a wider target for a worse estimator, and is compared "
        "within a plant only; for perfect information it asks for all radii within 5 cm of the well's floor.",
        panels={"table_iii": "completion, method's own σ [%]"},
    ),
    PairedRate(
        name="completion_common",
        summary=summaries.rate("completion_common"),
        title="band 1 m",
        values=trial_values.read("completion_common"),
        margin=0.1,
        columns=(Column(header="band 1 m", text=tables.rate, tables=("cases", "readings")),),
        note="Band 1 m: the band holds through the last 10 s and no hulls touched.",
        panels={
            "outcomes": "formation within 1 m,\nno contact [%]",
            "differences": "completion, 1 m [points]",
            "sensitivity": "formation within 1 m [%]",
        },
        ranking=Ranking(title="band 1 m", better="higher"),
    ),
)
PAIRED: tuple[PairedMeasure[Any], ...] = tuple(
    sorted((one for one in MEASURES if isinstance(one, PairedMeasure)), key=lambda one: one.paired_rank)
)
TESTED = tuple(one for one in PAIRED if one.tested)


def columns(table: TableName) -> list[tuple[Measure[Any], Column[Any]]]:
    """Returns the columns of a table, each with what it is of."""
    found = [(one, column) for one in MEASURES for column in one.columns if table in column.tables]
    return sorted(found, key=lambda pair: pair[1].rank)


def panels(figure: FigureName) -> list[tuple[Measure[Any], str]]:
    """Returns what a figure has a panel for, with the panel's title."""
    return [(one, one.panels[figure]) for one in MEASURES if figure in one.panels]
