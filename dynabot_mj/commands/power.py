"""`dynabot power`."""

import argparse
import hashlib
import sys
from dataclasses import asdict
from pathlib import Path

from dynabot_mj.commands import parsers, results
from dynabot_mj.common.exceptions import InputError

_FILES = ("power.json", "power.md", "power.png")


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    from dynabot_mj.experiments.formation import power_request
    from dynabot_mj.experiments.formation.measures import PAIRED

    names = [one.name for one in PAIRED]
    command = parsers.command(commands, power, parsers.shared())
    command.add_argument("pilot", type=Path, metavar="PILOT", help="a saved study, e.g. of dynabot compare --trials 50")
    command.add_argument(
        "--cases", nargs=2, required=True, metavar=("A", "B"), help="of it, e.g. rigid/gauss-markov/gps"
    )
    command.add_argument("--measure", required=True, choices=names, metavar="NAME", help=f"one of {', '.join(names)}")
    command.add_argument(
        "--difference",
        type=float,
        metavar="D",
        help="A - B that matters, in seconds, or in points of per cent (default the pilot's own, which is noisy)",
    )
    command.add_argument(
        "--power", type=float, default=0.8, help=f"chance to find it, at most {power_request.HIGHEST} (default 0.8)"
    )
    command.add_argument("--alpha", type=float, default=0.05, help="below which p is a finding (default 0.05)")
    command.add_argument(
        "--comparisons", type=int, default=1, metavar="K", help="tests of the family: alpha / K for each (default 1)"
    )
    parsers.add_out(command, "out/power")


def power(options: argparse.Namespace) -> None:
    """How many trials a difference between two cases needs, from a pilot study."""
    from dynabot_mj import study as studies
    from dynabot_mj.experiments.formation import power as experiment
    from dynabot_mj.experiments.formation import power_report, power_request
    from dynabot_mj.study import dataset, saved

    pilot, path = saved.load(options.pilot)
    if missing := studies.missing(pilot):
        raise InputError(f"the study {path} has no {missing[0]}, which its measures need; run it again")
    if len({part.attrs["duration"] for part in dataset.points(pilot)}) > 1:
        raise InputError(f"the study {path} is a grid of several durations, a pilot must have one")
    request = power_request.Request(
        a=options.cases[0],
        b=options.cases[1],
        **{name: getattr(options, name) for name in ("measure", "difference", "power", "alpha", "comparisons")},
    )
    measure = power_request.judge(pilot, request)
    if measure.unit == "points" and request.difference is not None and abs(request.difference) < 1.0:
        points = f"{100.0 * request.difference:g}"
        print(
            f"note: --difference is in points, less than one given; a share is --difference {points}", file=sys.stderr
        )
    depends_on = {"pilot": hashlib.sha256(path.read_bytes()).hexdigest()[:16], **asdict(request)}
    with results.opened(options, "power", depends_on, _FILES) as folder:
        plan = experiment.planned(pilot, request)
        document, text = power_report.document(plan), power_report.markdown(plan)
        from dynabot_mj.figures import power as figure
        from dynabot_mj.figures.style import save

        with results.report(options, folder, "power", document, text) as draft:
            save(figure.power(plan), draft / "power.png")
