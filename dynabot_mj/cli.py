"""The command line: one sub-command per file of `commands`, and how they end.

Exit codes: 0 done, 1 failure, 2 bad input (one line: what was given, what is allowed), 128 + n ended by signal n (130
Ctrl-C, 143 SIGTERM, 129 SIGHUP). With `--json`, one JSON document
is all that a command prints on standard output; progress goes to standard error.
"""

import argparse
import errno
import importlib
import io
import os
import signal
import sys
import threading
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

from dynabot_mj import __version__
from dynabot_mj.commands import parsers
from dynabot_mj.common import exceptions
from dynabot_mj.common.exceptions import DynabotError, InputError
from dynabot_mj.host import opengl

# Their help, in its order: what their functions say, which are not imported to be listed.
_COMMANDS = {
    "compare": "Every estimator on both plants, the paper's Table III beside them.",
    "study": "Any grid of configurations: every case of it, measures over its factors, differences on the same trials.",
    "run": "One trial of one case.",
    "video": "One trial of one case as a video, drawn without a display.",
    "view": "One trial of one case, watched: in MuJoCo's window where there is a display, else in the browser.",
    "report": "A study as one page of HTML that needs no network, with its tables as CSV.",
    "power": "How many trials a difference between two cases needs, from a pilot study.",
    "circle": "Uncertainty of the estimators on the paper's tether experiment: Table II and Fig. 3.",
    "estimate": "Runs estimators over a recorded log of sensor samples.",
    "drive": "Acceptance drive of the rigid robot, its motors commanded directly.",
    "tune": "Tunes the local laws with CasADi, and judges the result in MuJoCo on courses that it was not tuned on.",
    "track": "How well vehicles imitate particles, for each steering law and gain set.",
    "schedule": "Shortest periods that the processor can keep, Eqs. 1-3.",
    "benchmark": "What things cost: the loop against the raw engine, estimators, radio, environment and films.",
    "doctor": "What works on this machine: OpenGL, video encoder, versions; and how to mend what does not.",
}


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, and takes no abbreviations: `--trial` is not `--trials`."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options, allow_abbrev=False)

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Refuses what is unknown here, where the sub-command's own help can be named."""
        found, unknown = super().parse_known_args(args, namespace)
        if unknown:
            options = [name for action in self._actions for name in action.option_strings]
            self.error(f"unrecognized arguments: {' '.join(unknown)}{exceptions.suggestion(unknown[0], options)}")
        return found, unknown

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            choices = [str(one) for one in action.choices]
            hint = exceptions.suggestion(str(value), choices)
            raise argparse.ArgumentError(
                action, f"invalid choice: {value!r}{hint} (choose from {', '.join(map(repr, choices))})"
            )

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message} (see {self.prog} --help)")


class _Command(_Parser):
    """Stands for a sub-command until it is typed: only then is its file imported, and its own parser made."""

    def __init__(self, *, command: str, **options: Any) -> None:
        super().__init__(**options)
        self._command, self._prefix = command, self.prog.removesuffix(f" {command}")

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Hands everything to the sub-command's own parser."""
        opengl.import_unasked()  # commands import MuJoCo, some of them when they register already
        commands = _Parser().add_subparsers(prog=self._prefix, parser_class=_Parser)
        importlib.import_module(f"dynabot_mj.commands.{self._command}").add(commands)
        return commands.choices[self._command].parse_known_args(args, namespace)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a command and returns its exit code."""
    options = argparse.Namespace()
    try:
        _take_signals()
        _speak()
        # A notebook that starts us as a command names its own, without which Matplotlib cannot even be imported here.
        options.figures_asked, os.environ["MPLBACKEND"] = os.environ.get("MPLBACKEND"), "agg"
        options = _parser().parse_args(arguments, options)
        _judge_processes(options)
        command: Callable[[argparse.Namespace], None] = options.function
        command(options)
    except InputError as error:
        print(f"dynabot: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt as end:
        return _ended(end, options)
    except BrokenPipeError:
        # Whoever read our output has gone, e.g. `dynabot compare | head`.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except (DynabotError, OSError) as error:
        kept = getattr(options, "kept", "")  # of a study
        print(f"dynabot: {error}" + f"; {kept}" * bool(kept), file=sys.stderr)
        # A name that the system cannot have is the input's fault.
        return 2 if isinstance(error, OSError) and error.errno == errno.ENAMETOOLONG else 1
    except ImportError as error:
        # Libraries that are interrupted while they are imported say that they cannot be.
        causes: BaseException | None = error
        while causes is not None and not isinstance(causes, KeyboardInterrupt):
            causes = causes.__cause__ or causes.__context__
        if causes is None:
            raise
        return _ended(causes, options)
    return 0


def _judge_processes(options: argparse.Namespace) -> None:
    for name in ("workers", "threads"):
        given = getattr(options, name, None)
        if given is not None and given < 1:
            raise InputError(f"--{name} {given} given, it must be at least 1")
    if getattr(options, "workers", 0) is None:
        options.workers = parsers.cores()
    elif getattr(options, "scheduler", None) is not None:
        raise InputError(f"--workers {options.workers} given with --scheduler, whose cluster has its own")


def _ended(end: KeyboardInterrupt, options: argparse.Namespace) -> int:
    """Says that a command was ended, and returns its exit code."""
    number = end.number if isinstance(end, _EndedError) else signal.SIGINT
    how = "interrupted" if number == signal.SIGINT else f"ended by {signal.Signals(number).name}"
    kept = getattr(options, "kept", "")  # of a study
    print(f"dynabot: {how}" + f"; {kept}, --resume continues from them" * bool(kept), file=sys.stderr)
    return 128 + number


class _EndedError(KeyboardInterrupt):
    """A signal ends us as Ctrl-C does."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.number = number


def _take_signals() -> None:
    """Lets batch systems, containers and closed terminals end us as Ctrl-C does: orderly, with all our processes."""
    if threading.current_thread() is not threading.main_thread():
        return

    def end(number: int, frame: object) -> NoReturn:
        raise _EndedError(number)

    for name in ("SIGTERM", "SIGHUP"):
        # One that is ignored, as under nohup, stays so.
        if hasattr(signal, name) and signal.getsignal(getattr(signal, name)) == signal.SIG_DFL:
            signal.signal(getattr(signal, name), end)


def _speak() -> None:
    """Lets what a terminal or a file cannot show, such as ± in ASCII, be shown as something else instead of failing."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def _parser() -> _Parser:
    parser = _Parser(
        prog="dynabot", description="Formation control under limited computation, on particles and rigid bodies."
    )
    parser.add_argument("--version", action="version", version=f"dynabot-mj {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND", parser_class=_Command)
    for name, told in _COMMANDS.items():
        commands.add_parser(name, command=name, help=told)
    return parser
