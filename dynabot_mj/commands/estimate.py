"""`dynabot estimate`."""

import argparse
import hashlib
from dataclasses import asdict
from pathlib import Path

from dynabot_mj.commands import parsers, results


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    from dynabot_mj.estimation.build import IMPLEMENTATIONS, NAMES

    command = parsers.command(commands, estimate, parsers.shared())
    command.add_argument("log", type=Path, metavar="LOG", help="CSV or NetCDF of sensor samples, see docs/logs.md")
    command.add_argument("--estimators", nargs="+", choices=NAMES, default=NAMES, help="default all")
    command.add_argument(
        "--filters", choices=IMPLEMENTATIONS, default=IMPLEMENTATIONS[0], help="implementation (default batched)"
    )
    command.add_argument(
        "--config", type=Path, metavar="FILE.toml", help="as of `dynabot circle`; its [filter] says what filters assume"
    )
    parsers.add_out(command, "out/estimate")


def estimate(options: argparse.Namespace) -> None:
    """Runs estimators over a recorded log of sensor samples."""
    from dynabot_mj.estimation.build import NAMES
    from dynabot_mj.experiments.estimators import circle
    from dynabot_mj.experiments.estimators import estimate as experiment
    from dynabot_mj.figures import log as log_figure
    from dynabot_mj.figures.style import save
    from dynabot_mj.host import progress
    from dynabot_mj.sensing.logs import log as logs
    from dynabot_mj.study import configuration

    tree = configuration.read(options.config) if options.config else {}
    parameters = circle.request(tree, str(options.config)).filter
    log = logs.read(options.log)
    depends_on = {
        "log": {"name": options.log.name, "digest": hashlib.sha256(options.log.read_bytes()).hexdigest()[:16]},
        "estimators": list(options.estimators),
        "filters": options.filters,
        "filter": asdict(parameters),
    }
    names = ("estimate.json", "estimate.md", "estimate.png", *(f"track_{name}.csv" for name in NAMES))
    with results.opened(options, "estimate", depends_on, names) as folder:
        with progress.shown("estimate") as tell:
            found = experiment.run(options.log.name, log, options.estimators, options.filters, parameters, tell)
        document, text = experiment.document(found), experiment.markdown(found)
        with results.report(options, folder, "estimate", document, text) as draft:
            for name, track in found.tracks.items():
                (draft / f"track_{name}.csv").write_text(experiment.track_csv(track), encoding="utf-8")
            save(log_figure.replay(found), draft / "estimate.png")
