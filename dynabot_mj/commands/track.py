"""`dynabot track`."""

import argparse

from dynabot_mj.commands import parsers, results, studies
from dynabot_mj.common.exceptions import InputError


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    command = parsers.command(commands, track, parsers.shared(), parsers.execution(threads=False))
    command.add_argument("--trials", type=int, default=100, help="of each formation (default 100)")
    command.add_argument("--seed", type=int, default=0, help="of all random numbers (default 0)")
    parsers.add_out(command, "out/track")


def track(options: argparse.Namespace) -> None:
    """How well vehicles imitate particles, for each steering law and gain set."""
    from dynabot_mj.experiments.vehicle import track as experiment
    from dynabot_mj.experiments.vehicle import track_report
    from dynabot_mj.figures import tracking
    from dynabot_mj.figures.style import save
    from dynabot_mj.host import progress

    if options.trials < 1:
        raise InputError(f"--trials {options.trials} given, it must be at least 1")
    parsers.require_seed(options.seed)
    depends_on = {"seed": options.seed, "trials": options.trials}
    names = ("tracking.json", "tracking.md", "tracking.png")
    work = experiment.chunks(options.seed, options.trials)
    with studies.working(options, "track", depends_on, names, work) as (folder, how):
        with progress.shown("track") as tell:
            report = experiment.run(options.seed, options.trials, how, tell)
        document, text = track_report.document(report), track_report.markdown(report)
        with results.report(options, folder, "tracking", document, text) as draft:
            save(tracking.tracking(report), draft / "tracking.png")
