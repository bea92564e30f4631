"""The command line: one sub-command per use; nothing but parsing, calling and printing.

Exit codes: 0 done, 1 failure, 2 bad input (one line: what was given, what is allowed). With `--json`, one JSON document
is all that a command prints on standard output; progress goes to standard error.
"""

import argparse
import contextlib
import json
import os
import shlex
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, NoReturn

from dynabot_mj import __version__, files
from dynabot_mj.errors import InputError

_VEHICLE = ("model", "friction", "slope", "payload", "steering", "sensing", "gains")
_SCIENCE = ("seed", "robots", "duration", "utilisation", "headings", "trials", *_VEHICLE)  # they override the TOML
_CHOICES = {"plants": "plant", "estimators": "estimator", "perception": "perception"}  # key and option of `run`
_NONE: Mapping[str, Any] = {}
_CHUNKS = ".chunks"  # finished parts of a study, until it is complete


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one line."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message} (see {self.prog} --help)")


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a command and returns its exit code."""
    options = argparse.Namespace()
    try:
        options = _parser().parse_args(arguments)
        for name in ("workers", "threads"):
            if getattr(options, name, 1) < 1:
                raise InputError(f"--{name} {getattr(options, name)} given, it must be at least 1")
        command: Callable[[argparse.Namespace], None] = options.function
        command(options)
    except InputError as error:
        print(f"dynabot: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        resumes = hasattr(options, "resume")
        print("dynabot: interrupted" + "; --resume continues from what was finished" * resumes, file=sys.stderr)
        return 1
    except BrokenPipeError:
        # Whoever read our output has gone, e.g. `dynabot compare | head`.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except OSError as error:
        print(f"dynabot: {error}", file=sys.stderr)
        return 1
    return 0


def compare(options: argparse.Namespace) -> None:
    """Every estimator on both plants, the paper's Table III beside them."""
    from dynabot_mj import figures
    from dynabot_mj.experiments import compare as experiment

    folder = options.out or Path("out/compare")
    setup = _scenario(options, plants=options.plants, estimators=options.estimators, perception=options.perception)
    files.require_writable(folder)
    start = time.monotonic()
    study = _run(setup, folder, options, "compare")
    wall_s = time.monotonic() - start
    table = experiment.markdown(study)
    document = experiment.document(study)
    with _results(folder, setup, study, options, wall_s) as stage:
        (stage / "table.md").write_text(table, encoding="utf-8")
        (stage / "compare.json").write_text(_json(document), encoding="utf-8")
        figures.save(figures.table_iii(study), stage / "table_iii.png")
        for estimator in dict.fromkeys(setup.estimators):
            figures.save(figures.trajectories(study, estimator), stage / f"trajectories_{estimator}.png")
    _print(options, {**document, "wall_s": round(wall_s, 3)}, f"{table}\n{wall_s:.0f} s; results in {folder}")


def run(options: argparse.Namespace) -> None:
    """One trial of one case."""
    import numpy as np

    from dynabot_mj import figures
    from dynabot_mj.experiments import compare as experiment

    folder = options.out or Path("out/run")
    setup = _reproduced(options) if options.reproduce else _single(options)
    files.require_writable(folder)
    start = time.monotonic()
    study = _run(setup, folder, options, "run")
    wall_s = time.monotonic() - start
    case = study.isel(case=0)
    row = asdict(experiment.row(case))
    places = case.final_position_w.isel(trial=0).values
    row["final_position_m"] = [[float(x) if np.isfinite(x) else None for x in place] for place in places]
    with _results(folder, setup, study, options, wall_s) as stage:
        figures.save(figures.trajectories(study, setup.estimators[0]), stage / "trajectories.png")
    shown = ", ".join(f"({x:.2f}, {y:.2f})" for x, y in places)
    text = experiment.markdown(study) + f"\nfinal positions [m]: {shown}\n{wall_s:.1f} s; results in {folder}"
    _print(options, row, text)


def schedule(options: argparse.Namespace) -> None:
    """Shortest periods that the processor can keep, Eqs. 1-3."""
    from dynabot_mj import schedule as eqs

    rows = eqs.table(options.robots, options.utilisation)
    for row in rows:
        _note_load(row.estimator, row.load, options.utilisation)
    keys = ("estimator", "t_se_ms", "period_exact_ms", "period_ms")
    document = {
        "robots": options.robots,
        "utilisation": options.utilisation,
        "rows": [{key: getattr(row, key) for key in keys} for row in rows],
    }
    text = [f"{options.robots} robots, utilisation bound {options.utilisation:g}"]
    text += ["estimator  t_se [ms]  T exact [ms]  T [ms]"]
    text += [f"{r.estimator:<9}  {r.t_se_ms:9.1f}  {r.period_exact_ms:12.2f}  {r.period_ms:6g}" for r in rows]
    _print(options, document, "\n".join(text))


def drive(options: argparse.Namespace) -> None:
    """Acceptance drive of the rigid robot, its motors commanded directly."""
    from dynabot_mj import vehicle_figures
    from dynabot_mj.experiments import drive as experiment
    from dynabot_mj.experiments import drive_report
    from dynabot_mj.figures import save

    conditions = _conditions(options)
    folder = options.out or Path("out/drive")
    files.require_writable(folder)
    report = experiment.drive(conditions)
    document, text = drive_report.document(report), drive_report.markdown(report)
    if options.step_sizes:
        found = drive_report.step_sizes(conditions)
        document["step_sizes"] = drive_report.step_document(found)
        text += f"\n{drive_report.step_table(found)}"
    with files.staged(folder) as stage:
        (stage / "drive.json").write_text(_json(document), encoding="utf-8")
        (stage / "drive.md").write_text(text, encoding="utf-8")
        save(vehicle_figures.acceptance_drive(report), stage / "drive.png")
    _print(options, document, f"{text}\nresults in {folder}")


def tune(options: argparse.Namespace) -> None:
    """Tunes the local laws with CasADi, and judges the result in MuJoCo on courses that it was not tuned on."""
    from controllers import gains as gain_sets
    from dynabot_mj import manoeuvres, progress, tracking_figures
    from dynabot_mj.experiments import parity as models
    from dynabot_mj.experiments import tune_traction as experiment
    from dynabot_mj.figures import save

    folder = options.out or Path("out/tune-traction")
    request = experiment.Request(
        steering="heading" if options.steering == "heading" else "hand_point",
        start=options.start,
        against=options.against,
        conditions=_conditions(options),
        period=options.period,
        courses=tuple(manoeuvres.load(options.scenario)) if options.scenario else (),
        seed=options.seed,
    )
    experiment.check(request)
    files.require_writable(folder)
    with progress.shown("tune") as tell:
        result = experiment.run(request, tell)
    parity = models.parity(request.conditions)
    document, text = experiment.document(result, parity), experiment.markdown(result, parity)
    with files.staged(folder) as stage:
        name = "gains.toml" if result.validation.better else "not_adopted.toml"
        (stage / name).write_text(gain_sets.dump(result.solution.gains, result.provenance), encoding="utf-8")
        (stage / "tuning.json").write_text(_json(document), encoding="utf-8")
        (stage / "tuning.md").write_text(text, encoding="utf-8")
        save(tracking_figures.tuning(result), stage / "tuning.png")
        save(tracking_figures.parity(parity), stage / "parity.png")
    _print(options, document, f"{text}\nresults in {folder}; the gains are {folder / name}")


def track(options: argparse.Namespace) -> None:
    """How well vehicles imitate particles, for each steering law and gain set."""
    from dynabot_mj import progress, tracking_figures
    from dynabot_mj.experiments import track as experiment
    from dynabot_mj.figures import save

    if options.trials < 1:
        raise InputError(f"--trials {options.trials} given, it must be at least 1")
    _require_seed(options.seed)
    folder = options.out or Path("out/track")
    files.require_writable(folder)
    with progress.shown("track") as tell:
        report = experiment.run(options.seed, options.trials, options.workers, tell)
    document, text = experiment.document(report), experiment.markdown(report)
    with files.staged(folder) as stage:
        (stage / "tracking.json").write_text(_json(document), encoding="utf-8")
        (stage / "tracking.md").write_text(text, encoding="utf-8")
        save(tracking_figures.tracking(report), stage / "tracking.png")
    _print(options, document, f"{text}\nresults in {folder}")


def _conditions(options: argparse.Namespace) -> Any:
    """Returns which vehicle drives on what ground."""
    from dynabot_mj import scene
    from dynabot_mj.experiments import drive_report

    if options.friction is not None and not 0.05 <= options.friction <= 1.5:
        raise InputError(f"--friction {options.friction:g} given, allowed are 0.05 to 1.5")
    if not 0.0 <= options.payload <= drive_report.HEAVIEST_PAYLOAD:
        raise InputError(f"--payload {options.payload:g} given, allowed are 0 to {drive_report.HEAVIEST_PAYLOAD:g} kg")
    conditions = scene.Conditions(model=options.model, payload=options.payload, friction=options.friction)
    scene.read_robot(conditions)
    return conditions


def _require_seed(seed: int) -> None:
    if seed < 0:
        raise InputError(f"--seed {seed} given, it must not be negative")


def _folder(text: str) -> Path:
    if not text:
        raise argparse.ArgumentTypeError("an empty name given, it must be a folder")
    return Path(text)


def _friction(text: str) -> float | list[float]:
    try:
        values = [float(value) for value in text.split("..")]
    except ValueError:
        values = []
    if not 1 <= len(values) <= 2:
        raise argparse.ArgumentTypeError(
            f"{text!r} given, it must be a number such as 0.75 or a range such as 0.3..0.9"
        )
    return values[0] if len(values) == 1 else values


def _parser() -> _Parser:
    from dynabot_mj.scenario import ESTIMATORS, HEADINGS, PERCEPTIONS, PLANTS, SENSINGS, STEERINGS

    parser = _Parser(
        prog="dynabot", description="Formation control under limited computation, on particles and rigid bodies."
    )
    parser.add_argument("--version", action="version", version=f"dynabot-mj {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND", parser_class=_Parser)

    shared = _Parser(add_help=False)
    shared.add_argument("--json", action="store_true", help="print one JSON document")
    study = _Parser(add_help=False, parents=[shared])
    study.add_argument("--config", type=Path, metavar="FILE.toml", help="configuration; options override it")
    study.add_argument("--seed", type=int, help="seed of all random numbers (default 0)")
    study.add_argument("--robots", type=int, help="number of robots, 2 to 7 (default 3)")
    study.add_argument("--duration", type=float, help="of a trial [s] (default 80; below 13 nothing settles)")
    study.add_argument("--utilisation", type=float, help="bound U of Eq. 1 (default 1.0; Table I says 0.95)")
    study.add_argument("--headings", choices=HEADINGS, help="at the start (default random)")
    rigid = study.add_argument_group("rigid robots")
    rigid.add_argument("--model", metavar="FILE.xml", help="another robot's MJCF with the same names")
    rigid.add_argument(
        "--friction",
        type=_friction,
        metavar="MU",
        help="of tyres and ground (default 0.75), or MIN..MAX: one per trial",
    )
    rigid.add_argument("--slope", type=float, help="rise of the ground per metre toward +x (default 0)")
    rigid.add_argument("--payload", type=float, metavar="KG", help="mass on each robot's top (default 0)")
    rigid.add_argument("--steering", choices=STEERINGS, help="steering law (default hand-point)")
    rigid.add_argument("--sensing", choices=SENSINGS, help="what the local laws run on (default on-board)")
    rigid.add_argument("--gains", metavar="SET", help="of the local laws: tuned, first, or a gain file (default tuned)")
    study.add_argument("--out", type=_folder, metavar="DIR", help="folder of the results (default out/COMMAND)")
    study.add_argument("--workers", type=int, default=_cores(), help="processes (default: all cores)")
    study.add_argument("--threads", type=int, default=1, help="of MuJoCo in each process (default 1)")
    study.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask cluster that works in place of the processes")
    study.add_argument("--resume", action="store_true", help="continue an interrupted run of the same study")

    command = commands.add_parser("compare", parents=[study], help=compare.__doc__, description=compare.__doc__)
    command.add_argument("--trials", type=int, help="trials of each case (default 100)")
    command.add_argument("--plants", nargs="+", choices=PLANTS)
    command.add_argument("--estimators", nargs="+", choices=ESTIMATORS)
    command.add_argument("--perception", nargs="+", choices=PERCEPTIONS)
    command.set_defaults(function=compare)

    command = commands.add_parser("run", parents=[study], help=run.__doc__, description=run.__doc__)
    command.add_argument("--plant", choices=PLANTS, help="default rigid")
    command.add_argument("--estimator", choices=ESTIMATORS, help="default decoupled")
    command.add_argument("--perception", choices=PERCEPTIONS, help="default gauss-markov")
    command.add_argument("--trial", type=int, help="its number (default 0)")
    command.add_argument(
        "--reproduce",
        metavar="STUDY:CASE:TRIAL",
        help="repeat a trial of a saved study, e.g. out/compare:rigid/perfect:7",
    )
    command.set_defaults(function=run)

    vehicle = _Parser(add_help=False, parents=[shared])
    vehicle.add_argument("--model", default="dynabot", metavar="FILE.xml", help="another robot's MJCF, same names")
    vehicle.add_argument("--friction", type=float, metavar="MU", help="of tyres and ground (default the model's)")
    vehicle.add_argument("--payload", type=float, default=0.0, metavar="KG", help="mass on the robot's top (default 0)")
    vehicle.add_argument("--out", type=_folder, metavar="DIR", help="folder of the results (default out/COMMAND)")

    command = commands.add_parser("drive", parents=[vehicle], help=drive.__doc__, description=drive.__doc__)
    command.add_argument("--step-sizes", action="store_true", help="repeat it for physics steps from 0.5 to 8 ms too")
    command.set_defaults(function=drive)

    command = commands.add_parser("tune", parents=[vehicle], help=tune.__doc__, description=tune.__doc__)
    command.add_argument("what", choices=["traction"], help="which laws")
    command.add_argument("--steering", choices=STEERINGS, default="hand-point", help="law (default hand-point)")
    command.add_argument(
        "--start", default="first", metavar="SET", help="gain set or file to start from (default first)"
    )
    command.add_argument(
        "--against", default="first", metavar="SET", help="what the result has to beat (default first)"
    )
    command.add_argument("--period", type=float, default=0.036, help="control period T_c [s] (default 0.036)")
    command.add_argument("--scenario", type=Path, metavar="FILE.toml", help="courses to tune on (default random ones)")
    command.add_argument("--seed", type=int, default=0, help="of the courses (default 0)")
    command.set_defaults(function=tune)

    command = commands.add_parser("track", parents=[shared], help=track.__doc__, description=track.__doc__)
    command.add_argument("--trials", type=int, default=100, help="of each formation (default 100)")
    command.add_argument("--seed", type=int, default=0, help="of all random numbers (default 0)")
    command.add_argument("--workers", type=int, default=_cores(), help="processes (default: all cores)")
    command.add_argument("--out", type=_folder, metavar="DIR", help="folder of the results (default out/track)")
    command.set_defaults(function=track)

    command = commands.add_parser("schedule", parents=[shared], help=schedule.__doc__, description=schedule.__doc__)
    command.add_argument("--robots", type=int, default=3, help="number of robots, 2 to 7 (default 3)")
    command.add_argument("--utilisation", type=float, default=1.0, help="bound U of Eq. 1 (default 1.0)")
    command.set_defaults(function=schedule)
    return parser


def _scenario(options: argparse.Namespace, defaults: Mapping[str, Any] = _NONE, **others: Any) -> Any:
    """Builds the configuration: defaults, then the file, then the options."""
    from dynabot_mj import configuration

    given = {**{name: getattr(options, name, None) for name in _SCIENCE}, **others}
    if options.config:
        return configuration.load_file(options.config, defaults, **given)
    return configuration.build(defaults, **given)


def _single(options: argparse.Namespace) -> Any:
    """Builds the configuration of one trial of one case."""
    setup = _scenario(
        options,
        {"plants": ["rigid"], "estimators": ["decoupled"]},
        trials=1,
        first_trial=options.trial,
        **{name: [value] if (value := getattr(options, option)) else None for name, option in _CHOICES.items()},
    )
    for name, option in _CHOICES.items():
        choices = dict.fromkeys(getattr(setup, name))
        if len(choices) > 1:
            raise InputError(f"{', '.join(choices)} given by {options.config}; run takes one: choose with --{option}")
    return setup


def _reproduced(options: argparse.Namespace) -> Any:
    """Builds the configuration of one trial of a saved study."""
    from dynabot_mj import configuration, scenario, study

    others = ("config", "plant", "estimator", "perception", "trial", *_SCIENCE)
    if given := [name for name in others if getattr(options, name, None) is not None]:
        raise InputError(f"--{given[0]} given with --reproduce, which takes everything from the saved study")
    try:
        folder, label, trial = options.reproduce.rsplit(":", 2)
        number = int(trial)
    except ValueError:
        raise InputError(f"--reproduce {options.reproduce!r} given, it must be STUDY:CASE:TRIAL") from None
    path = Path(folder) / "study.nc" if Path(folder).is_dir() else Path(folder)
    if not path.is_file():
        raise InputError(f"there is no study at {path}")
    try:
        saved = study.load(path)
    except (OSError, ValueError) as error:
        raise InputError(f"cannot read the study {path}: {error}") from error
    labels = [str(one) for one in saved.case.values]
    if label not in labels:
        raise InputError(f"case {label!r} given, the study has: {', '.join(labels)}")
    if number not in saved.trial.values:
        raise InputError(f"trial {number} given, the study has {saved.trial.values[0]} to {saved.trial.values[-1]}")
    setup = configuration.load(saved.attrs["configuration"], str(path))
    was = json.loads(saved.attrs.get("inputs", "{}"))  # older studies do not say
    for name, digest in scenario.inputs(setup).items():
        if was.get(name) != digest:
            raise InputError(f"the {name} {getattr(setup.vehicle, name)!r} of {path} has changed since that study")
    return scenario.one_trial(setup, label, number)


def _run(setup: Any, folder: Path, options: argparse.Namespace, title: str) -> Any:
    """Runs a study with progress; its finished chunks outlive an interruption."""
    from dynabot_mj import progress, scenario, study
    from dynabot_mj.execution import Execution

    for estimator, load in scenario.loads(setup).items():
        _note_load(estimator, load, setup.processor.utilisation)

    execution = Execution(
        workers=options.workers,
        threads=options.threads,
        scheduler=options.scheduler,
        chunks=folder / _CHUNKS,
        resume=options.resume,
    )
    with progress.shown(title) as tell:
        return study.run(setup, execution, tell)


def _note_load(estimator: str, load: float, bound: float) -> None:
    """Says that rounding the periods to the timer's tick overloads the processor, as in the paper."""
    if load > bound + 5e-5:  # in the digits shown
        print(
            f"note: the rounded periods of {estimator} load the processor {load:.4f}, above {bound:g}; "
            "feasibility is judged before rounding",
            file=sys.stderr,
        )


@contextlib.contextmanager
def _results(folder: Path, setup: Any, dataset: Any, options: argparse.Namespace, wall_s: float) -> Iterator[Path]:
    """Yields a folder for further results beside what every study leaves behind, and keeps them all at once."""
    from dynabot_mj import study
    from dynabot_mj.execution import forget

    execution = {
        "command": shlex.join(["dynabot", *sys.argv[1:]]),
        "workers": options.workers,
        "threads": options.threads,
        "wall_s": round(wall_s, 3),
        "cores": _cores(),
    }
    with files.staged(folder) as stage:
        study.save(dataset, stage / "study.nc")
        (stage / "study.toml").write_text(dataset.attrs["configuration"], encoding="utf-8")
        (stage / "execution.json").write_text(_json(execution), encoding="utf-8")
        yield stage
    forget(setup, folder / _CHUNKS)


def _cores() -> int:
    """Returns how many cores this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on this system
        return os.cpu_count() or 1


def _print(options: argparse.Namespace, document: Any, text: str) -> None:
    print(_json(document) if options.json else text)


def _json(document: Any) -> str:
    return json.dumps(document, indent=2, allow_nan=False)
