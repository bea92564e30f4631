"""What a report says of a study, and in what order."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from dynabot_mj.experiments.estimators import circle_report
from dynabot_mj.experiments.estimators.circle import CircleOutcome
from dynabot_mj.experiments.formation import compare, compare_tables, in_loop
from dynabot_mj.experiments.formation.compare import Comparison
from dynabot_mj.figures import autocorrelations, bars, distributions, one_trial, paths
from dynabot_mj.figures import circle as circle_figure
from dynabot_mj.perception import methods
from dynabot_mj.report import csv_tables, page, svg
from dynabot_mj.report.page import Section
from dynabot_mj.viewing.recording import Recording


@dataclass(frozen=True, kw_only=True)
class Material:
    """All that a report is made of."""

    study: xr.Dataset
    execution: Mapping[str, Any]  # of execution.json; empty where there is none
    recordings: Sequence[Recording]  # of the study's first trial, one of each case; empty where it cannot be repeated
    recordings_note: str  # what has to be said of them; may be empty
    clip: bytes | None  # a film of one of them, mp4
    clip_note: str  # what it shows, or why there is none
    circle: CircleOutcome


@dataclass(frozen=True, kw_only=True)
class Contents:
    """The page, and the CSV tables that it carries by file name."""

    html: str
    tables: Mapping[str, str]


def build(material: Material) -> Contents:
    """Tells a study."""
    study = material.study
    comparison = compare.compared(study)
    tables = {**csv_tables.of_study(comparison), **csv_tables.of_circle(material.circle)}
    sections = [
        _result(comparison, tables),
        _film(material),
        _differences(comparison, tables),
        _reproduction(comparison),
        _distributions(study, tables),
        _paths(study),
        _over_time(material),
        _estimates(study, tables),
        _circle(material.circle, tables),
        _origin(study, material.execution),
    ]
    command = material.execution.get("command")
    made = f"<p>Made by <code>{escape(command)}</code></p>" if command else ""
    html = page.html(
        compare_tables.title(study),
        f"<p>{_INTRODUCTION}</p>\n{made}",
        [section for section in sections if section is not None],
        f"<p>{escape(study.attrs['title'])}. This page needs nothing but itself.</p>",
    )
    return Contents(html=html, tables=tables)


_INTRODUCTION = """Robots share one processor between estimation, control and radio, and gather around a leader. The
same forces, errors and messages, trial by trial, drive point masses and rigid, skidding vehicles: what differs is the
body, with the local laws that drive it."""


def _result(comparison: Comparison, tables: Mapping[str, str]) -> Section:
    parts = [
        _figure(
            bars.outcomes(comparison),
            "bars",
            "Arrival, time to formation, contacts of hulls and formations within a common metre. Whiskers: standard "
            "deviation of the arrival, 95 % intervals of the others.",
        ),
        page.table(compare_tables.table(comparison)),
        _downloads(tables, "cases.csv", "trials.csv"),
    ]
    return Section(title="Result", parts=parts)


def _reproduction(comparison: Comparison) -> Section:
    parts = [
        _figure(
            bars.table_iii(comparison),
            "table-iii",
            "Settling, collisions of centres and completion within each method's own sigma, beside the paper's Table "
            "III. Whiskers: standard deviation of the settling time, 95 % Wilson intervals of the rates.",
        ),
        page.table(compare_tables.reproduction(comparison)),
    ]
    return Section(title="Beside the paper", parts=parts)


def _film(material: Material) -> Section:
    shown = page.film(material.clip, material.clip_note) if material.clip else page.paragraphs(material.clip_note)
    return Section(title="Film", parts=[shown])


def _differences(comparison: Comparison, tables: Mapping[str, str]) -> Section | None:
    told = compare_tables.tests(comparison)
    if not told:
        return None
    parts = []
    if (figure := distributions.differences(comparison)) is not None:
        caption = "Mean paired differences between the plants with 95 % intervals. Points: percentage points."
        parts.append(_figure(figure, "differences", caption))
    for table in told:
        parts += [page.heading(table.title), page.table(table)]
    return Section(title="What differs", parts=[*parts, _downloads(tables, "differences.csv")])


def _distributions(study: xr.Dataset, tables: Mapping[str, str]) -> Section:
    parts = []
    if (figure := distributions.incidence(study)) is not None:
        caption = (
            "Formation and contact as competing outcomes: the share of the trials that has formed by a time, from "
            "below, and that has touched or overturned before it formed, from above."
        )
        parts.append(_figure(figure, "incidence", caption))
    parts += [
        _figure(
            distributions.closest(study),
            "closest",
            "How near two centres came in a trial, of all trials. Shaded: nearer than the collision distance.",
        ),
        _downloads(tables, "trials.csv"),
    ]
    return Section(title="Distributions", parts=parts)


def _paths(study: xr.Dataset) -> Section:
    shown = dict.fromkeys(zip(map(str, study.estimator.values), map(str, study.perception.values), strict=True))
    parts = [
        _figure(
            paths.trajectories(study, estimator, perception),
            "-".join(["paths", estimator, *([perception] if perception else [])]),
            f"Whole paths above, the end near the leader below: {methods.label(estimator, perception)}.",
        )
        for estimator, perception in shown
    ]
    return Section(title="Paths", parts=[page.paragraphs("As in the paper's Fig. 4, of the first trial."), *parts])


def _over_time(material: Material) -> Section:
    parts = [page.paragraphs(material.recordings_note)] if material.recordings_note else []
    if material.recordings:
        drawn = (
            (one_trial.distance, "Distances to the leader. Shaded: the floor of the leader's well."),
            (
                one_trial.message_age,
                "Time since the positions were sampled that robots have of each other: mean, and lowest to highest.",
            ),
            (one_trial.effort, "Control effort: size of the forces that the robots command."),
            (one_trial.slip, "Slip of the tyres: of each robot's four, the largest."),
            (
                one_trial.estimate_error,
                "What robot 1 believes of its own x, less where it is, and three standard deviations of that belief.",
            ),
        )
        for draw, caption in drawn:
            if (figure := draw(material.recordings)) is not None:
                parts.append(_figure(figure, draw.__name__.replace("_", "-"), caption))
    return Section(title="One trial over time", parts=parts)


def _estimates(study: xr.Dataset, tables: Mapping[str, str]) -> Section | None:
    figure, table = autocorrelations.errors(study), in_loop.table(study)
    if figure is None or table is None:
        return None
    caption = "How long errors last: autocorrelation of the errors of the believed positions, and their size."
    parts = [_figure(figure, "errors", caption), page.table(table), _downloads(tables, "cases.csv")]
    return Section(title="Errors in the loop", parts=parts)


def _circle(outcome: CircleOutcome, tables: Mapping[str, str]) -> Section:
    caption = (
        "As in the paper's Fig. 3: what the estimators make of the same samples of one run, by the study's sensors "
        "without faults, and how far they are from the best-fit actual path at most."
    )
    parts = [
        _figure(circle_figure.paths(outcome), "circle", caption),
        page.heading(circle_report.table(outcome).title),
        page.table(circle_report.table(outcome)),
        _downloads(tables, "circle.csv"),
    ]
    return Section(title="Estimators on a tether", parts=parts)


def _origin(study: xr.Dataset, execution: Mapping[str, Any]) -> Section:
    facts = {"seed": str(study.attrs["seed"]), "versions": escape(study.attrs["versions"])}
    inputs = json.loads(study.attrs.get("inputs", "{}"))  # older studies do not say
    facts |= {f"digest of the {name}": f"<code>{escape(digest)}</code>" for name, digest in inputs.items()}
    if "command" in execution:
        facts["command"] = f"<code>{escape(execution['command'])}</code>"
    if "wall_s" in execution:
        facts["executed"] = (
            f"in {execution['wall_s']:.0f} s, processes: {execution['workers']}, "
            f"threads in each: {execution['threads']}, cores: {execution['cores']}"
        )
    parts = [page.facts(facts), page.collapsed("Configuration: study.toml", study.attrs["configuration"])]
    return Section(title="How it was made", parts=parts)


def _figure(drawn: Figure, name: str, caption: str) -> str:
    return page.figure(svg.inline(drawn, name, caption), caption)


def _downloads(tables: Mapping[str, str], *files: str) -> str:
    return page.downloads({name: tables[name] for name in files})
