"""What commands that run a study share: its configuration, the run with progress, and what it leaves behind."""

import argparse
import contextlib
import shlex
import sys
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from dynabot_mj import files
from dynabot_mj.commands import parsers, results

_VEHICLE = ("model", "friction", "slope", "payload", "steering", "sensing", "gains")
SCIENCE = (
    "seed",
    "robots",
    "duration",
    "utilisation",
    "headings",
    "velocity",
    "controller",
    "trials",
    *_VEHICLE,
)  # they override the TOML
_NONE: Mapping[str, Any] = {}
_CHUNKS = ".chunks"  # finished parts of a study, until it is complete


def build(options: argparse.Namespace, defaults: Mapping[str, Any] = _NONE, **others: Any) -> Any:
    """Builds the configuration: defaults, then the file, then the options."""
    from dynabot_mj import configuration

    given = {**{name: getattr(options, name, None) for name in SCIENCE}, **others}
    if options.config:
        return configuration.load_file(options.config, defaults, **given)
    return configuration.build(defaults, **given)


def run(setup: Any, folder: Path, options: argparse.Namespace, title: str, *, notes: bool = True) -> tuple[Any, float]:
    """Runs a study with progress; its finished chunks outlive an interruption.

    Args:
        setup: Its configuration.
        folder: Of its results, which the chunks are kept in until it is complete.
        options: How it is executed.
        title: Of the progress.
        notes: Whether to say what rounding does to the load.

    Returns:
        The Dataset and the time that it took [s].
    """
    from dynabot_mj import progress, scenario, study
    from dynabot_mj.execution import Execution

    start = time.monotonic()
    for estimator, load in scenario.loads(setup).items() if notes else ():
        note_load(estimator, load, setup.processor.utilisation)

    execution = Execution(
        workers=options.workers,
        threads=options.threads,
        scheduler=options.scheduler,
        chunks=folder / _CHUNKS,
        resume=options.resume,
    )
    with progress.shown(title) as tell:
        dataset = study.run(setup, execution, tell)
    return dataset, time.monotonic() - start


@contextlib.contextmanager
def staged(folder: Path, setup: Any, dataset: Any, options: argparse.Namespace, wall_s: float) -> Iterator[Path]:
    """Yields a folder for further results beside what every study leaves behind, and keeps them all at once."""
    from dynabot_mj import study
    from dynabot_mj.execution import forget

    execution = {
        "command": shlex.join(["dynabot", *sys.argv[1:]]),
        "workers": options.workers,
        "threads": options.threads,
        "wall_s": round(wall_s, 3),
        "cores": parsers.cores(),
    }
    with files.staged(folder) as stage:
        study.save(dataset, stage / "study.nc")
        (stage / "study.toml").write_text(dataset.attrs["configuration"], encoding="utf-8")
        (stage / "execution.json").write_text(results.dump(execution), encoding="utf-8")
        yield stage
    forget(setup, folder / _CHUNKS)


def note_late(comparison: Any) -> None:
    """Says that a case was too short for its robots to arrive."""
    from dynabot_mj.experiments import compare

    if line := compare.late(comparison):
        print(f"note: {line}", file=sys.stderr)


def note_load(estimator: str, load: float, bound: float) -> None:
    """Says that rounding the periods to the timer's tick overloads the processor, as in the paper."""
    if load > bound + 5e-5:  # in the digits shown
        print(
            f"note: the rounded periods of {estimator} load the processor {load:.4f}, above {bound:g}; "
            "feasibility is judged before rounding",
            file=sys.stderr,
        )
