"""`dynabot benchmark`."""

import argparse
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from dynabot_mj.commands import parsers, results
from dynabot_mj.common.exceptions import InputError

_SIZES = {"filters": (300, 40), "environment": (3, 5), "video": (3, 90)}  # robots, repetitions


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    command = parsers.command(commands, benchmark, parsers.shared())
    command.add_argument("subject", choices=list(_SIZES), help="the estimators; the dm_env environment; films")
    command.add_argument("--robots", type=int, help="in a batch (default 300); in an environment or film (default 3)")
    command.add_argument("--repetitions", type=int, help="of each time (default 40; environment 5; film 90 pictures)")
    command.add_argument(
        "--config", type=Path, metavar="FILE.toml", help="of filters: [method.NAME] of yours, see docs/own-estimator.md"
    )
    parsers.add_out(command, "out/benchmark")


def benchmark(options: argparse.Namespace) -> None:
    """What the estimators cost, in time and operations; the environment, against mj_step alone; or films."""
    from dynabot_mj.host import progress

    for name, default in zip(("robots", "repetitions"), _SIZES[options.subject], strict=True):
        if getattr(options, name) is None:
            setattr(options, name, default)
        if getattr(options, name) < 1:
            raise InputError(f"--{name} {getattr(options, name)} given, it must be at least 1")
    if options.config and options.subject != "filters":
        raise InputError(f"--config given with {options.subject}, it is of filters alone")
    own = _own(options.config) if options.config else {}
    depends_on = {name: getattr(options, name) for name in ("subject", "robots", "repetitions")}
    if own:
        depends_on["methods"] = {name: asdict(row) for name, row in own.items()}
    with results.opened(options, "benchmark", depends_on, ("benchmark.json", "benchmark.md")) as folder:
        with progress.shown("benchmark") as tell:
            document, text = (
                _filters(options.robots, options.repetitions, tell, own)
                if options.subject == "filters"
                else _MEASURES[options.subject](options.robots, options.repetitions, tell)
            )
        with results.report(options, folder, "benchmark", document, text):
            pass  # there are no figures


def _own(config: Path) -> Mapping[str, Any]:
    """Returns the methods of the user's in a configuration."""
    from dynabot_mj.experiments.estimators import circle
    from dynabot_mj.study import configuration

    return circle.request(configuration.read(config), str(config)).method or {}


def _filters(robots: int, repetitions: int, tell: Callable[[float], None], own: Mapping[str, Any]) -> tuple[Any, str]:
    from dynabot_mj.experiments.estimators import benchmark as experiment

    report = experiment.filters(robots, repetitions, tell, own)
    return experiment.document(report), experiment.markdown(report)


def _environment(robots: int, repetitions: int, tell: Callable[[float], None]) -> tuple[Any, str]:
    from dynabot_mj.environment import benchmark as experiment

    rows = experiment.run(robots, repetitions, tell)
    return experiment.document(rows, robots, repetitions), experiment.markdown(rows, robots, repetitions)


def _video(robots: int, repetitions: int, tell: Callable[[float], None]) -> tuple[Any, str]:
    from dynabot_mj.film import benchmark as experiment

    rows = experiment.run(robots, repetitions, tell)
    return experiment.document(rows, robots, repetitions), experiment.markdown(rows, robots, repetitions)


_MEASURES = {"environment": _environment, "video": _video}
