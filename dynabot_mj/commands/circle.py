"""`dynabot circle`."""

import argparse
from dataclasses import asdict
from pathlib import Path

from dynabot_mj.commands import parsers, results, studies
from dynabot_mj.common.exceptions import InputError

_FILES = ("circle.json", "circle.md", "circle.toml", "fig_3.png", "errors.png")
_CHECKS = ("grouping", "consistency", "faults")


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    from dynabot_mj.experiments.estimators.circle import PLANTS
    from dynabot_mj.experiments.estimators.kinematic import PATHS

    command = parsers.command(commands, circle, parsers.shared(), parsers.execution(threads=False))
    command.add_argument(
        "--config", type=Path, metavar="FILE.toml", help="the same, [sensors] and [filter]; options override"
    )
    command.add_argument("--runs", type=int, help="default 200")
    command.add_argument("--seed", type=int, help="of all random numbers (default 0)")
    command.add_argument("--duration", type=float, help="of a run, of which 15 s are dropped [s] (default 100)")
    command.add_argument("--period", type=float, help="sampling period T_s [s] (default 0.036)")
    command.add_argument(
        "--plant",
        choices=PLANTS,
        help="a vehicle that follows the path exactly (default), or one on a tether in MuJoCo",
    )
    command.add_argument("--path", choices=PATHS, help="default circle; the others for the kinematic plant only")
    command.add_argument("--log", type=Path, metavar="FILE", help="write the first run's samples there, .csv or .nc")
    checks = command.add_mutually_exclusive_group()
    checks.add_argument("--grouping", action="store_true", help="derive the decoupled EKF's sub-states from the gains")
    checks.add_argument("--consistency", action="store_true", help="NEES, NIS and whiteness of both EKFs")
    checks.add_argument("--faults", action="store_true", help="what faults of the sensors cost each estimator")
    parsers.add_out(command, "out/circle")


def circle(options: argparse.Namespace) -> None:
    """Uncertainty of the estimators on the paper's tether experiment: Table II and Fig. 3."""
    for check in _CHECKS:
        if getattr(options, check):
            _check(options, check)
            return
    from dynabot_mj.experiments.estimators import circle as experiment
    from dynabot_mj.experiments.estimators import circle_report
    from dynabot_mj.figures import circle
    from dynabot_mj.figures.style import save
    from dynabot_mj.host import progress
    from dynabot_mj.sensing.logs import files, log
    from dynabot_mj.study import configuration

    request = experiment.request(
        configuration.read(options.config) if options.config else {},
        str(options.config or "options"),
        **{name: getattr(options, name) for name in ("runs", "seed", "duration", "period", "plant", "path")},
    )
    if options.log:
        files.require_writable(options.log)
    with studies.working(options, "circle", asdict(request), _FILES, experiment.chunks(request)) as (folder, how):
        with progress.shown("circle") as tell:
            outcome = experiment.run(request, tell, how)
        document, text = circle_report.document(outcome), circle_report.markdown(outcome)
        note = f"; the first run's samples are {options.log}" if options.log else ""
        with results.report(options, folder, "circle", document, text, note) as draft:
            (draft / "circle.toml").write_text(experiment.dump(request), encoding="utf-8")
            save(circle.paths(outcome), draft / "fig_3.png")
            save(circle.errors(outcome), draft / "errors.png")
            if options.log:
                first = outcome.example
                log.write(options.log, log.from_run(first.samples, first.truth, 0, request.sensors.wheels))


def _check(options: argparse.Namespace, name: str) -> None:
    """Runs one of the checks of the filters, which have the kinematic circle and sensors of their own."""
    from dynabot_mj.experiments.estimators import consistency, consistency_report, faults, faults_report, grouping

    for other in ("config", "duration", "period", "plant", "path", "log", "scheduler", "resume"):
        if getattr(options, other) not in (None, False):
            raise InputError(f"--{other} given with --{name}, which takes --runs and --seed only")
    if options.runs is not None and options.runs < 2:
        raise InputError(f"--runs {options.runs} given with --{name}, it must be at least 2")
    seed = options.seed or 0
    parsers.require_seed(seed)
    experiment, report = {
        "grouping": (grouping, grouping),
        "consistency": (consistency, consistency_report),
        "faults": (faults, faults_report),
    }[name]
    size = {} if options.runs is None else {"runs": options.runs}
    with results.opened(options, f"circle/{name}", {"seed": seed, **size}, (f"{name}.json", f"{name}.md")) as folder:
        found = experiment.run(seed, **size)
        with results.report(options, folder, name, report.document(found), report.markdown(found)):
            pass
