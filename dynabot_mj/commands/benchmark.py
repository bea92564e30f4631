"""`dynabot benchmark`."""

import argparse

from dynabot_mj.commands import parsers, results
from dynabot_mj.errors import InputError


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    command = parsers.command(commands, benchmark, parsers.shared())
    command.add_argument("subject", choices=["filters"], help="what is measured: the three estimators")
    command.add_argument("--robots", type=int, default=300, help="in a batch (default 300)")
    command.add_argument("--repetitions", type=int, default=40, help="of each time (default 40)")
    parsers.add_out(command, "out/benchmark")


def benchmark(options: argparse.Namespace) -> None:
    """What the estimators cost: time in Python, and floating-point operations."""
    from dynabot_mj import progress
    from dynabot_mj.experiments import benchmark as experiment

    for name in ("robots", "repetitions"):
        if getattr(options, name) < 1:
            raise InputError(f"--{name} {getattr(options, name)} given, it must be at least 1")
    folder = results.open_folder(options, "benchmark")
    with progress.shown("benchmark") as tell:
        report = experiment.filters(options.robots, options.repetitions, tell)
    document, text = experiment.document(report), experiment.markdown(report)
    with results.report(options, folder, "benchmark", document, text):
        pass  # there are no figures
