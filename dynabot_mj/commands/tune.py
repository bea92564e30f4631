"""`dynabot tune`."""

import argparse
from dataclasses import asdict
from pathlib import Path

from dynabot_mj.commands import parsers, results

_GAINS = {True: "gains.toml", False: "not_adopted.toml"}  # by whether they are adopted


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    from dynabot_mj.plants.options import STEERINGS

    command = parsers.command(commands, tune, parsers.vehicle())
    command.add_argument("what", choices=["traction"], help="which laws")
    command.add_argument("--steering", choices=STEERINGS, default="hand-point", help="law (default hand-point)")
    command.add_argument(
        "--start", default="first", metavar="SET", help="gain set or file to start from (default first)"
    )
    command.add_argument(
        "--against", default="first", metavar="SET", help="what the result has to beat (default first)"
    )
    command.add_argument("--period", type=float, default=0.036, help="control period T_c [s] (default 0.036)")
    command.add_argument("--courses", type=Path, metavar="FILE.toml", help="to tune on (default random ones)")
    parsers.renamed(command, "--scenario", "--courses")
    command.add_argument("--seed", type=int, default=0, help="of the courses (default 0)")
    parsers.add_workers(command)


def tune(options: argparse.Namespace) -> None:
    """Tunes the local laws with CasADi, and judges the result in MuJoCo on courses that it was not tuned on."""
    from dynabot_mj.controllers import gains as gain_sets
    from dynabot_mj.experiments.vehicle import manoeuvres, tune_traction_report
    from dynabot_mj.experiments.vehicle import parity as models
    from dynabot_mj.experiments.vehicle import tune_traction as experiment
    from dynabot_mj.figures import tracking
    from dynabot_mj.figures.style import save
    from dynabot_mj.host import progress
    from dynabot_mj.study.execution import Execution

    request = experiment.TuningRequest(
        steering="heading" if options.steering == "heading" else "hand_point",
        start=options.start,
        against=options.against,
        conditions=parsers.conditions(options),
        period=options.period,
        courses=tuple(manoeuvres.load(options.courses)) if options.courses else (),
        seed=options.seed,
    )
    experiment.check(request)
    names = ("tuning.json", "tuning.md", "tuning.png", "parity.png", *_GAINS.values())
    with results.opened(options, "tune-traction", asdict(request), names) as folder:
        with progress.shown("tune") as tell:
            result = experiment.run(request, tell, Execution(workers=options.workers))
        parity = models.parity(request.conditions)
        document, text = tune_traction_report.document(result, parity), tune_traction_report.markdown(result, parity)
        name = _GAINS[result.adopted]
        note = f"; the gains are {folder.path / name}"
        with results.report(options, folder, "tuning", document, text, note) as draft:
            (draft / name).write_text(gain_sets.dump(result.solution.gains, result.provenance), encoding="utf-8")
            save(tracking.tuning(result), draft / "tuning.png")
            save(tracking.parity(parity), draft / "parity.png")
