"""The main question: does the answer of the point-mass study survive rigid, skidding vehicles?

From the Dataset of a study to rows with intervals, paired differences between the plants, and a table that shows the
paper's Table III beside both.
"""

import itertools
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import xarray as xr

from dynabot_mj import control_laws, statistics
from dynabot_mj.experiments import in_loop, tables
from dynabot_mj.experiments.in_loop import EstimateError
from dynabot_mj.experiments.tables import Table
from dynabot_mj.statistics import Mean, Rate
from dynabot_mj.testbed import ROBOTS, TABLE_III, TableIIIRow

# JSON name and Dataset variable of what is compared between plants, trial by trial.
PAIRED_METRICS = {
    "settling_s": "settling",
    "top_speed_mps": "top_speed",
    "collision": "collision",
    "collision_footprint": "collision_footprint",
    "completion": "completion",
    "completion_common": "completion_common",
}


@dataclass(frozen=True, kw_only=True)
class Settling(Mean):
    """Settling time over the trials that neither collided nor stayed unsettled."""

    unsettled: Rate  # among the trials that did not collide


@dataclass(frozen=True, kw_only=True)
class Published:
    """The same row of the paper's Table III."""

    settling_s: float
    collision: float
    completion: float


@dataclass(frozen=True, kw_only=True)
class Row:
    """One case, summarised over its trials; diverged trials count in `diverged` and nowhere else."""

    plant: str
    perception: str | None
    estimator: str
    trials: int
    period_ms: float  # T_c
    sample_period_ms: float  # T_s
    alpha_h: float
    alpha_d: float
    settling_s: Settling
    top_speed_mps: Mean
    collision: Rate
    collision_footprint: Rate
    hull_contact: Rate  # undefined for point masses
    completion: Rate
    completion_common: Rate
    diverged: int
    velocity: str  # where the dissipation's comes from
    estimate_error: EstimateError | None  # None for perfect information
    paper: Published


@dataclass(frozen=True, kw_only=True)
class Paired:
    """Mean difference a - b of a metric over the trials where both cases have a value."""

    a: str
    b: str
    metric: str
    difference: float | None
    low: float | None
    high: float | None
    n: int


def row(case: xr.Dataset) -> Row:
    """Summarises one case of a study's Dataset."""
    estimator = str(case.estimator.item())
    published = TABLE_III[estimator]
    settling = statistics.mean(case.settling)
    return Row(
        plant=str(case.plant.item()),
        perception=str(case.perception.item()) or None,
        estimator=estimator,
        trials=case.sizes["trial"],
        # The periods are whole ticks; the digits beyond are floating-point noise.
        period_ms=round(1e3 * case.control_period.item(), 9),
        sample_period_ms=round(1e3 * case.sample_period.item(), 9),
        alpha_h=case.alpha_h.item(),
        alpha_d=case.alpha_d.item(),
        settling_s=Settling(**asdict(settling), unsettled=statistics.rate(1.0 - case.settled)),
        top_speed_mps=statistics.mean(case.top_speed),
        collision=statistics.rate(case.collision),
        collision_footprint=statistics.rate(case.collision_footprint),
        hull_contact=statistics.rate(case.hull_contact),
        completion=statistics.rate(case.completion),
        completion_common=statistics.rate(case.completion_common),
        diverged=int(case.diverged.sum()),
        velocity=str(case.velocity.item()),
        estimate_error=in_loop.errors(case),
        paper=Published(settling_s=published.settling, collision=published.collision, completion=published.completion),
    )


def rows(study: xr.Dataset) -> list[Row]:
    """Summarises every case of a study."""
    return [row(study.isel(case=index)) for index in range(study.sizes["case"])]


def paired(study: xr.Dataset) -> list[Paired]:
    """Compares cases of one estimator on the same trials that differ in the plant alone, or in the perception alone.

    Particle minus rigid where both plants are there, an earlier perception minus a later one.
    """
    found = []
    for a, b in itertools.combinations(range(study.sizes["case"]), 2):
        one, other = study.isel(case=a), study.isel(case=b)
        same_plant, same_perception = (one[name] == other[name] for name in ("plant", "perception"))
        if one.estimator != other.estimator or bool(same_plant) == bool(same_perception):
            continue
        if str(one.plant.item()) > str(other.plant.item()):
            one, other = other, one
        for metric, variable in PAIRED_METRICS.items():
            # The bootstrap's seed is the study's: the same Dataset gives the same interval.
            difference = statistics.paired_difference(one[variable], other[variable], int(study.attrs["seed"]))
            found.append(Paired(a=str(one.case.item()), b=str(other.case.item()), metric=metric, **asdict(difference)))
    return found


def document(study: xr.Dataset) -> dict[str, Any]:
    """Returns the JSON document of `dynabot compare`, but for the time that it took."""
    return {"rows": [asdict(one) for one in rows(study)], "paired": [asdict(one) for one in paired(study)]}


def markdown(study: xr.Dataset) -> str:
    """Returns the result as readable tables, the paper's rows beside."""
    errors = in_loop.table(study)
    others = [*difference_tables(study), *([errors] if errors else [])]
    return "\n\n".join([table(study).markdown(level=1), *(one.markdown() for one in others)]) + "\n"


def table(study: xr.Dataset) -> Table:
    """Returns the cases as a table, the paper's rows beside."""
    summary = rows(study)
    robots, trials = study.sizes["robot"], study.sizes["trial"]
    count = f"{trials} trials" if trials > 1 else "1 trial"
    sources = {one.perception or "perfect": one.velocity for one in summary}
    told = ", ".join(f"{source} ({perception})" for perception, source in sources.items())
    note = f"{_NOTE}\n\nVelocity of the dissipation: {told}."
    controller = study.attrs.get("controller", control_laws.BUILT_IN)  # older studies do not say
    if controller != control_laws.BUILT_IN:
        note += f"\n\nController: {controller}, in place of the paper's potential field; its gains are not used."
    return Table(
        title=f"Formation of {robots} robots, {count} of {study.attrs['duration']:g} s, seed {study.attrs['seed']}",
        header=_header(),
        body=_body(summary, robots),
        note=note,
    )


def difference_tables(study: xr.Dataset) -> list[Table]:
    """Returns the paired differences, those between plants and those between perceptions, where there are any."""
    differences = paired(study)
    found = [
        Table(
            title=title,
            header=["estimator", "difference", *_DIFFERENCE_HEADER.values()],
            body=_difference_body(chosen),
        )
        for title, what in (
            ("Particle minus rigid body, on the same trials", "plant"),
            ("One perception minus another, on the same trials", "perception"),
        )
        if (chosen := [one for one in differences if _changes(one, what)])
    ]
    return [*found[:-1], *(replace(last, note=_DIFFERENCE_NOTE) for last in found[-1:])]


_NOTE = """Rates in % with 95 % Wilson intervals; settling as mean ± sd over the n trials that neither collided nor
stayed unsettled. Hulls: footprints, which reach 1 cm beyond the hulls, overlap; contact: the simulator found
a hull touched. Band 1 m: the completion criterion common to all rows. Runs shorter than 13 s have neither
settling nor completion (-)."""

_DIFFERENCE_NOTE = """\
Mean paired differences with 95 % bootstrap intervals; rates in percentage points. Settling (n): over the
n trials that settled without a collision in both cases, which the outcome selects. An interval of no
width means that all pairs are equal, not that the rates are known exactly: see their intervals above."""


def _changes(difference: Paired, what: str) -> bool:
    """Tells whether plant, or perception, is what two cases differ in."""
    (a, *_), (b, *_) = difference.a.split("/"), difference.b.split("/")
    return (a != b) == (what == "plant")


_DIFFERENCE_HEADER = {
    "settling_s": "settling [s] (n)",
    "top_speed_mps": "top speed [m/s]",
    "collision": "collision",
    "collision_footprint": "hulls",
    "completion": "completion",
    "completion_common": "band 1 m",
}


def _header() -> list[str]:
    return [
        "estimator",
        "plant",
        "perception",
        "T_s, T_c [ms]",
        "gains",
        "settling [s]",
        "n",
        "unsettled",
        "top speed [m/s]",
        "collision",
        "hulls",
        "contact",
        "completion",
        "band 1 m",
        "diverged",
    ]


def _body(summary: Sequence[Row], robots: int) -> list[list[str]]:
    # The paper has results for three robots only; beside another fleet they are a point of reference.
    paper = "paper" if robots == ROBOTS else f"paper, {ROBOTS} robots"
    body = []
    for estimator, group in itertools.groupby(summary, lambda one: one.estimator):
        body.append([estimator, paper, "", *_published(TABLE_III[estimator])])
        for one in group:
            body.append(
                [
                    "",
                    one.plant,
                    one.perception or "",
                    f"{one.sample_period_ms:g}, {one.period_ms:g}",
                    f"{one.alpha_h:g}, {one.alpha_d:g}",
                    tables.mean(one.settling_s),
                    str(one.settling_s.n),
                    tables.rate(one.settling_s.unsettled),
                    tables.mean(one.top_speed_mps),
                    tables.rate(one.collision),
                    tables.rate(one.collision_footprint),
                    tables.rate(one.hull_contact),
                    tables.rate(one.completion),
                    tables.rate(one.completion_common),
                    str(one.diverged),
                ]
            )
    return body


def _published(row: TableIIIRow) -> list[str]:
    """Returns the cells of a row of Table III, with its own period and gains."""
    period, spread = f"{1e3 * row.period:g}", "" if row.settling_sd is None else f" ± {row.settling_sd:g}"
    rates = f"{100 * row.collision:.0f}", f"{100 * row.completion:.0f}"
    gains = f"{row.alpha_h:g}, {row.alpha_d:g}"
    return [f"{period}, {period}", gains, f"{row.settling:g}{spread}", "", "", "", rates[0], "", "", rates[1], "", ""]


def _difference_body(differences: Sequence[Paired]) -> list[list[str]]:
    body = []
    for (a, b), group in itertools.groupby(differences, lambda one: (one.a, one.b)):
        by_metric = {one.metric: one for one in group}
        (one, estimator), (other, _) = a.rsplit("/", 1), b.rsplit("/", 1)
        cells = (_difference(by_metric[metric]) for metric in _DIFFERENCE_HEADER)
        body.append([estimator, f"{one} - {other}", *cells])
    return body


def _difference(value: Paired) -> str:
    if value.difference is None:
        return "-"
    scale, digits = (1.0, 2) if value.metric in ("settling_s", "top_speed_mps") else (100.0, 0)
    text = f"{scale * value.difference:+.{digits}f}"
    if value.low is not None and value.high is not None:
        text += f" [{scale * value.low:+.{digits}f}, {scale * value.high:+.{digits}f}]"
    if value.metric == "settling_s":
        text += f" ({value.n})"
    return text
