"""`dynabot estimate`."""

import argparse
import hashlib
from dataclasses import asdict
from pathlib import Path

from dynabot_mj.commands import parsers, results
from dynabot_mj.common.exceptions import InputError, suggestion


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    from dynabot_mj.perception.estimators import IMPLEMENTATIONS, NAMES

    command = parsers.command(commands, estimate, parsers.shared())
    command.add_argument("log", type=Path, metavar="LOG", help="CSV or NetCDF of sensor samples, see docs/logs.md")
    command.add_argument(
        "--estimators", nargs="+", metavar="NAME", help=f"{', '.join(NAMES)}, or of the configuration; default all"
    )
    command.add_argument(
        "--filters", choices=IMPLEMENTATIONS, default=IMPLEMENTATIONS[0], help="implementation (default batched)"
    )
    command.add_argument(
        "--config", type=Path, metavar="FILE.toml", help="as of `dynabot circle`; its [filter] says what filters assume"
    )
    parsers.add_out(command, "out/estimate")


def estimate(options: argparse.Namespace) -> None:
    """Runs estimators over a recorded log of sensor samples."""
    from dynabot_mj.experiments.estimators import circle
    from dynabot_mj.experiments.estimators import estimate as experiment
    from dynabot_mj.figures import log as log_figure
    from dynabot_mj.figures.style import save
    from dynabot_mj.host import progress
    from dynabot_mj.sensing.logs import log as logs
    from dynabot_mj.study import configuration

    tree = configuration.read(options.config) if options.config else {}
    request = circle.request(tree, str(options.config))
    own = {name: str(row.filter) for name, row in (request.method or {}).items()}
    chosen = options.estimators or request.estimators
    for name in chosen:
        if name not in request.estimators:
            allowed = ", ".join(request.estimators)
            raise InputError(
                f"--estimators {name} given, it must be one of {allowed}{suggestion(name, request.estimators)}"
            )
    if own and options.filters == "filterpy" and set(own) & set(chosen):
        raise InputError(f"--filters filterpy given with {next(iter(own))}, which is not on FilterPy")
    log = logs.read(options.log)
    depends_on = {
        "log": {"name": options.log.name, "digest": hashlib.sha256(options.log.read_bytes()).hexdigest()[:16]},
        "estimators": list(chosen),
        "filters": options.filters,
        "filter": asdict(request.filter),
    }
    names = ("estimate.json", "estimate.md", "estimate.png", *(f"track_{name}.csv" for name in request.estimators))
    with results.opened(options, "estimate", depends_on, names) as folder:
        with progress.shown("estimate") as tell:
            found = experiment.run(options.log.name, log, chosen, options.filters, request.filter, tell, own)
        document, text = experiment.document(found), experiment.markdown(found)
        with results.report(options, folder, "estimate", document, text) as draft:
            for name, track in found.tracks.items():
                (draft / f"track_{name}.csv").write_text(experiment.track_csv(track), encoding="utf-8")
            save(log_figure.replay(found), draft / "estimate.png")
