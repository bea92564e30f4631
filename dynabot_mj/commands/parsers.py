"""Registering a sub-command, and the options that several of them have.

The parsers returned here are parents: argparse copies their options into a sub-command's own parser.
"""

import argparse
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

from dynabot_mj.common.exceptions import InputError

# A string, because argparse's class, which has no public name, takes a parameter in its type stubs only.
Commands: TypeAlias = "argparse._SubParsersAction[Any]"


def command(
    commands: Commands, function: Callable[[argparse.Namespace], None], *parents: argparse.ArgumentParser
) -> argparse.ArgumentParser:
    """Registers a function as the sub-command of its name; its docstring is the help.

    Returns:
        The sub-command's parser, which takes its own options.
    """
    parser: argparse.ArgumentParser = commands.add_parser(
        function.__name__, parents=parents, help=function.__doc__, description=function.__doc__
    )
    parser.set_defaults(function=function)
    return parser


def shared() -> argparse.ArgumentParser:
    """Returns what every command has."""
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    return parser


def science() -> argparse.ArgumentParser:
    """Returns the options that override a configuration; `setups.build` reads them."""
    from dynabot_mj.formation.options import HEADINGS
    from dynabot_mj.plants.options import SENSINGS, STEERINGS
    from dynabot_mj.study.scenario import VELOCITIES

    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--config", type=Path, metavar="FILE.toml", help="configuration; options override it")
    parser.add_argument("--seed", type=int, help="seed of all random numbers (default 0)")
    parser.add_argument("--robots", type=int, help="number of robots, 2 to 7 (default 3)")
    parser.add_argument("--duration", type=float, help="of a trial [s] (default 80; below 13 nothing settles)")
    parser.add_argument("--utilisation", type=float, help="bound U of Eq. 1 (default 1.0; Table I says 0.95)")
    parser.add_argument("--headings", choices=HEADINGS, help="at the start (default random)")
    parser.add_argument(
        "--velocity",
        choices=VELOCITIES,
        help="of the dissipation (default auto: true where the velocity is exact, else estimated); "
        "odometry and reference are of rigid robots only",
    )
    parser.add_argument(
        "--controller", metavar="MODULE:FUNCTION", help="a law of yours in place of the potential field"
    )
    rigid = parser.add_argument_group("rigid robots")
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
    rigid.add_argument(
        "--sensing",
        choices=SENSINGS,
        help="what the local laws run on (default on-board: ideal but for the wheels' slip, with the sensors' errors "
        "where real filters run)",
    )
    rigid.add_argument("--gains", metavar="SET", help="of the local laws: tuned, first, or a gain file (default tuned)")
    return parser


def study() -> argparse.ArgumentParser:
    """Returns the options of a study: those of `shared` and `science`, and where its results go."""
    parser = argparse.ArgumentParser(add_help=False, parents=[shared(), science()])
    add_out(parser)
    return parser


def methods_help() -> str:
    """Returns what `--estimators` may be."""
    from dynabot_mj.perception.methods import METHODS

    return f"{', '.join(METHODS)}, or a method of yours, see docs/own-estimator.md"


def execution(*, threads: bool = True) -> argparse.ArgumentParser:
    """Returns how a study of several parts is executed.

    Args:
        threads: Whether their number may be chosen.
    """
    parser = argparse.ArgumentParser(add_help=False)
    add_workers(parser)
    if threads:
        parser.add_argument("--threads", type=int, default=1, help="of MuJoCo in each process (default 1)")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask cluster that works in place of the processes")
    parser.add_argument("--resume", action="store_true", help="continue an interrupted run of the same study")
    return parser


def vehicle() -> argparse.ArgumentParser:
    """Returns the options of single vehicles, beside those of `shared`; `conditions` reads them."""
    parser = argparse.ArgumentParser(add_help=False, parents=[shared()])
    parser.add_argument("--model", default="dynabot", metavar="FILE.xml", help="another robot's MJCF, same names")
    parser.add_argument("--friction", type=float, metavar="MU", help="of tyres and ground (default the model's)")
    parser.add_argument("--payload", type=float, default=0.0, metavar="KG", help="mass on the robot's top (default 0)")
    add_out(parser)
    return parser


def add_out(parser: argparse.ArgumentParser, default: str = "out/COMMAND") -> None:
    """Adds the options that `results.opened` reads."""
    parser.add_argument("--out", type=_folder, metavar="DIR", help=f"folder of the results (default {default})")
    parser.add_argument("--overwrite", action="store_true", help="replace other results in the folder that --out gives")


def add_workers(parser: argparse.ArgumentParser) -> None:
    """Adds the number of processes, None where it is not given; `cli` judges it for all commands at once."""
    parser.add_argument("--workers", type=int, help="processes (default: all cores)")


def renamed(parser: argparse.ArgumentParser, old: str, new: str) -> None:
    """Answers an option that has another name now with that name."""

    class Renamed(argparse.Action):
        def __call__(self, *given: Any) -> None:
            raise InputError(f"{old} is called {new} now")

    parser.add_argument(old, action=Renamed, nargs="?", help=argparse.SUPPRESS)


def conditions(options: argparse.Namespace) -> Any:
    """Returns which vehicle drives on what ground.

    Raises:
        InputError: If a value is out of range or the model cannot be read.
    """
    from dynabot_mj.experiments.vehicle import drive_report
    from dynabot_mj.plants import scene

    if options.friction is not None and not 0.05 <= options.friction <= 1.5:
        raise InputError(f"--friction {options.friction:g} given, allowed are 0.05 to 1.5")
    if not 0.0 <= options.payload <= drive_report.HEAVIEST_PAYLOAD:
        raise InputError(f"--payload {options.payload:g} given, allowed are 0 to {drive_report.HEAVIEST_PAYLOAD:g} kg")
    given = scene.Conditions(model=options.model, payload=options.payload, friction=options.friction)
    scene.read_robot(given)
    return given


def require_seed(seed: int) -> None:
    """Judges the seed of a command that has no configuration to do it.

    Raises:
        InputError: If it is negative.
    """
    if seed < 0:
        raise InputError(f"--seed {seed} given, it must not be negative")


def cores() -> int:
    """Returns how many cores this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on this system
        return os.cpu_count() or 1


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
