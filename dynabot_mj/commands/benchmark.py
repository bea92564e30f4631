"""`dynabot benchmark`."""

import argparse
import datetime
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from dynabot_mj.commands import parsers, results
from dynabot_mj.common.exceptions import InputError


@dataclass(frozen=True, kw_only=True)
class _Subject:
    """What can be measured."""

    robots: int | None  # None: of all numbers
    repetitions: int
    among_all: int  # repetitions where all subjects are measured, in less than four minutes
    work: float  # rough seconds of these


_SUBJECTS = {
    "loop": _Subject(robots=3, repetitions=3, among_all=2, work=85.0),
    "filters": _Subject(robots=300, repetitions=40, among_all=10, work=3.0),
    "radio": _Subject(robots=None, repetitions=10, among_all=5, work=10.0),
    "environment": _Subject(robots=3, repetitions=5, among_all=2, work=35.0),
    "video": _Subject(robots=3, repetitions=90, among_all=10, work=30.0),
}
_OWN_METHODS = "filters"  # the subject that measures the user's too


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    command = parsers.command(commands, benchmark, parsers.shared())
    command.add_argument(
        "subject",
        nargs="?",
        choices=list(_SUBJECTS),
        help="the study's loop against the raw engine; the estimators; the radio; the dm_env environment; films "
        "(default: all, in less than four minutes)",
    )
    command.add_argument(
        "--robots", type=int, help="in a batch of filters (default 300); in a loop, environment or film (default 3)"
    )
    command.add_argument(
        "--repetitions",
        type=int,
        help="of each time (default loop 3, filters 40, radio 10, environment 5; film 90 pictures)",
    )
    command.add_argument(
        "--config", type=Path, metavar="FILE.toml", help="of filters: [method.NAME] of yours, see docs/own-estimator.md"
    )
    parsers.add_out(command, "out/benchmark")


def benchmark(options: argparse.Namespace) -> None:
    """What things cost: the loop against the raw engine, estimators, radio, environment and films."""
    from dynabot_mj.host import progress

    _judge(options)
    own = _own(options.config) if options.config else {}
    depends_on: dict[str, Any] = {"subject": options.subject or "all"}
    chosen = [options.subject] if options.subject else list(_SUBJECTS)
    sizes = {name: _sizes(options, name) for name in chosen}
    if options.subject:
        depends_on |= dict(zip(("robots", "repetitions"), sizes[options.subject], strict=True))
    if own:
        depends_on["methods"] = {name: asdict(row) for name, row in own.items()}
    document: dict[str, Any] = {}
    texts = []
    with results.opened(options, "benchmark", depends_on, ("benchmark.json", "benchmark.md")) as folder:
        with progress.shown("benchmark") as tell:
            for name in chosen:
                found, text = _measured(name, *sizes[name], _part(tell, chosen, name), own, skipping=len(chosen) > 1)
                document |= found
                texts.append(text)
        document["made"] = _made()
        texts.append("Made {date}, {cores} cores; {versions}.\n".format(**document["made"]))
        with results.report(options, folder, "benchmark", document, "\n".join(texts)):
            pass  # there are no figures


def _judge(options: argparse.Namespace) -> None:
    """Refuses what does nothing, or nothing that means something.

    Raises:
        InputError: If there is such an option.
    """
    for name in ("robots", "repetitions"):
        given = getattr(options, name)
        if given is None:
            continue
        if options.subject is None:
            raise InputError(f"--{name} given without a subject: each has sizes of its own, name one")
        if name == "robots" and _SUBJECTS[options.subject].robots is None:
            raise InputError(f"--robots given with {options.subject}, which measures all numbers of them")
        if given < 1:
            raise InputError(f"--{name} {given} given, it must be at least 1")
    if options.config and options.subject not in (_OWN_METHODS, None):
        raise InputError(f"--config given with {options.subject}, it is of {_OWN_METHODS} alone")


def _sizes(options: argparse.Namespace, name: str) -> tuple[int | None, int]:
    """Returns robots and repetitions of a subject."""
    subject = _SUBJECTS[name]
    if options.subject is None:
        return subject.robots, subject.among_all
    robots = subject.robots if options.robots is None else options.robots
    return robots, subject.repetitions if options.repetitions is None else options.repetitions


def _part(tell: Callable[[float], None], chosen: list[str], name: str) -> Callable[[float], None]:
    """Returns what is told the share of one subject."""
    works = [_SUBJECTS[one].work for one in chosen]
    before = sum(works[: chosen.index(name)])
    return lambda share: tell((before + share * _SUBJECTS[name].work) / sum(works))


def _measured(
    name: str,
    robots: int | None,
    repetitions: int,
    tell: Callable[[float], None],
    own: Mapping[str, Any],
    *,
    skipping: bool,
) -> tuple[dict[str, Any], str]:
    """Returns the document and the text of a subject; of films, where nothing can be drawn, that they are skipped."""
    from dynabot_mj.host.opengl import GraphicsError

    try:
        return _MEASURES[name](robots, repetitions, tell, own)
    except GraphicsError as error:
        if not skipping:
            raise
        return {name: {"skipped": str(error)}}, f"# {name}\n\nSkipped: {error}\n"


def _made() -> dict[str, Any]:
    """Returns when, by what and on how many cores."""
    from dynabot_mj.study import provenance

    return {
        "date": datetime.date.today().isoformat(),
        "versions": provenance.versions(),
        "cores": parsers.cores(),
    }


def _own(config: Path) -> Mapping[str, Any]:
    """Returns the methods of the user's in a configuration."""
    from dynabot_mj.experiments.estimators import circle
    from dynabot_mj.study import configuration

    return circle.request(configuration.read(config), str(config)).method or {}


def _loop(robots: int, repetitions: int, tell: Callable[[float], None], own: Mapping[str, Any]) -> tuple[Any, str]:
    from dynabot_mj.experiments.formation import loop_benchmark, loop_benchmark_report

    report = loop_benchmark.run(robots, repetitions, tell)
    return loop_benchmark_report.document(report), loop_benchmark_report.markdown(report)


def _filters(robots: int, repetitions: int, tell: Callable[[float], None], own: Mapping[str, Any]) -> tuple[Any, str]:
    from dynabot_mj.experiments.estimators import benchmark as experiment

    report = experiment.filters(robots, repetitions, tell, own)
    return experiment.document(report), experiment.markdown(report)


def _radio(robots: None, repetitions: int, tell: Callable[[float], None], own: Mapping[str, Any]) -> tuple[Any, str]:
    from dynabot_mj.experiments.formation import radio_benchmark

    rows = radio_benchmark.run(repetitions, tell)
    return radio_benchmark.document(rows, repetitions), radio_benchmark.markdown(rows, repetitions)


def _environment(
    robots: int, repetitions: int, tell: Callable[[float], None], own: Mapping[str, Any]
) -> tuple[Any, str]:
    from dynabot_mj.environment import benchmark as experiment

    rows = experiment.run(robots, repetitions, tell)
    return experiment.document(rows, robots, repetitions), experiment.markdown(rows, robots, repetitions)


def _video(robots: int, repetitions: int, tell: Callable[[float], None], own: Mapping[str, Any]) -> tuple[Any, str]:
    from dynabot_mj.film import benchmark as experiment

    rows = experiment.run(robots, repetitions, tell)
    return experiment.document(rows, robots, repetitions), experiment.markdown(rows, robots, repetitions)


_MEASURES: Mapping[str, Callable[..., tuple[dict[str, Any], str]]] = {
    "loop": _loop,
    "filters": _filters,
    "radio": _radio,
    "environment": _environment,
    "video": _video,
}
