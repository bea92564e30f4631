"""What commands that run a study share: its configuration, the run with progress, and what it leaves behind."""

import argparse
import contextlib
import json
import shlex
import shutil
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from dynabot_mj.commands import parsers, results
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.host.files import PARTIAL
from dynabot_mj.host.result_folder import ResultFolder

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
_STUDY, _EXECUTION = "study.nc", "execution.json"
_OPTIONS = {"implementation": "filters", "first_trial": "trial"}  # that are called otherwise than their keys
_FILES = (_STUDY, "study.toml", _EXECUTION)  # of every study


def build(options: argparse.Namespace, defaults: Mapping[str, Any] = _NONE, **others: Any) -> Any:
    """Builds the configuration: defaults, then the file, then the options.

    Raises:
        InputError: If it contradicts itself, or an option does nothing in this study.
    """
    from dynabot_mj.study import configuration

    given, typed = overriding(options, **others)
    if options.config:
        setup = configuration.load_file(options.config, defaults, typed, **given)
    else:
        setup = configuration.build(defaults, typed=typed, **given)
    look_for_idle(options, setup, typed)
    return setup


def overriding(options: argparse.Namespace, **others: Any) -> tuple[dict[str, Any], dict[str, str]]:
    """Returns the keys that options override, and what was typed to set each, by the key with its table."""
    from dynabot_mj.study import configuration

    given = {**{name: getattr(options, name, None) for name in SCIENCE}, **others}
    tables = configuration.TABLES
    single = {"estimators": "estimator", "plants": "plant"} if hasattr(options, "estimator") else {}
    typed = {
        f"{tables[name]}.{name}" if name in tables else name: f"--{single.get(name) or _OPTIONS.get(name, name)}"
        for name, value in given.items()
        if value is not None
    }
    return given, typed


def look_for_idle(options: argparse.Namespace, setup: Any, typed: Mapping[str, str]) -> None:
    """Refuses options that do nothing in a study, and says which keys of its file do nothing."""
    from dynabot_mj.plants.kinds import any_bodies
    from dynabot_mj.study import idle_keys

    idle = idle_keys.idle(setup)
    for key, option in typed.items():
        if why := idle.get(key) or idle.get(key.rpartition(".")[0]):
            raise InputError(f"{option} given, but {why}")
    if getattr(options, "threads", 1) > 1 and not any_bodies(setup.plants):
        raise InputError(f"--threads {options.threads} given, but they are MuJoCo's, and the study has no rigid robots")
    for why in dict.fromkeys((changed := idle_keys.changed(setup)).values()):
        keys = ", ".join(key for key, reason in changed.items() if reason == why)
        print(f"note: {keys} in {options.config}: no effect, since {why}", file=sys.stderr)
    if not any_bodies(setup.plants) and {"vehicle.model", "vehicle.payload"} & set(typed):
        print("note: of the vehicle point masses take the mass and the footprint", file=sys.stderr)


@contextlib.contextmanager
def opened(
    options: argparse.Namespace, name: str, made: Any, names: Sequence[str], kept: Callable[[Path], str] | None = None
) -> Iterator[ResultFolder]:
    """Opens the folder of a study's results; says which parts are there to resume, and which an early end leaves.

    See `results.opened`.

    Args:
        options: The command's.
        name: Of the command.
        made: The campaign.
        names: Patterns of the files that will be written beside those of every study.
        kept: Says which parts a folder keeps, where the study has parts of its own.
    """
    from dynabot_mj.study import provenance

    told = kept or (lambda folder: told_kept([(made, folder)]))
    depends_on = provenance.depends_on(made.first) | made.grid_values
    with results.opened(options, name, depends_on, (*_FILES, *names), told) as folder:
        if options.resume and (found := told(folder.path)):
            print(f"note: {found}", file=sys.stderr)
        try:
            yield folder
        except BaseException:  # the command's last line tells what outlives it
            options.kept = told(folder.path)
            raise


@contextlib.contextmanager
def working(
    options: argparse.Namespace, name: str, depends_on: Mapping[str, Any], names: Sequence[str], chunks: Sequence[Any]
) -> Iterator[tuple[ResultFolder, Any]]:
    """Opens the folder of results that chunks of work make which are no trials of a study, and forgets the chunks.

    Args:
        options: The command's, with those of `parsers.execution`.
        name: Of the command.
        depends_on: What the results depend on, as plain values.
        names: Patterns of the files that will be written.
        chunks: The work.

    Yields:
        The folder, and how to execute the chunks.
    """
    from dynabot_mj.study import execution

    def told(folder: Path) -> str:
        there, whole = execution.kept(chunks, folder / _CHUNKS)
        return f"kept {there} of {whole} parts" if there else ""

    with results.opened(options, name, depends_on, names, told) as folder:
        if options.resume and (found := told(folder.path)):
            print(f"note: {found}", file=sys.stderr)
        place = folder.path / _CHUNKS
        try:
            yield (
                folder,
                execution.Execution(
                    workers=options.workers, scheduler=options.scheduler, chunks=place, resume=options.resume
                ),
            )
        except BaseException:  # the command's last line tells what outlives it
            options.kept = told(folder.path)
            raise
        execution.forget(chunks, place)


def again(options: argparse.Namespace, folder: ResultFolder, document: str, text: str) -> bool:
    """Prints what a finished study printed, where that is all that `--resume` has left to do.

    Args:
        options: The command's.
        folder: Of `opened`.
        document: Name of the file with its JSON document.
        text: Name of the file with its text.

    Returns:
        Whether there is nothing more to do.
    """
    if not (options.resume and folder.whole):
        return False
    known = json.loads((folder.path / document).read_text(encoding="utf-8"))
    show(options, folder, known, (folder.path / text).read_text(encoding="utf-8"), _wall_s(folder))
    return True


def show(options: argparse.Namespace, folder: ResultFolder, document: Any, text: str, wall_s: float) -> None:
    """Prints the results of a study."""
    results.show(options, {**document, "wall_s": round(wall_s, 3)}, f"{text}\n{wall_s:.0f} s; results in {folder.path}")


def obtain(made: Any, folder: ResultFolder, options: argparse.Namespace, title: str) -> tuple[Any, float]:
    """Runs a study, or reads it where `--resume` finds it finished.

    Args:
        made: Its campaign.
        folder: Of `opened`.
        options: How it is executed.
        title: Of the progress.

    Returns:
        The Dataset and the time that it took [s].
    """
    from dynabot_mj import study

    if options.resume and folder.same and (folder.path / _STUDY).is_file():
        return study.load(folder.path / _STUDY), _wall_s(folder)  # another of its files is missing
    return run(made, folder.path, options, title)


def run(
    made: Any, folder: Path | None, options: argparse.Namespace, title: str, *, notes: bool = True
) -> tuple[Any, float]:
    """Runs a study with progress; its finished chunks outlive an interruption.

    Args:
        made: Its campaign.
        folder: Which the chunks are kept in until it is complete, and the Dataset, which is read from there as it is
            asked for; None: all of it in memory.
        options: How it is executed.
        title: Of the progress.
        notes: Whether to say what rounding does to the load.

    Returns:
        The Dataset and the time that it took [s].
    """
    from dynabot_mj.commands import watching
    from dynabot_mj.study import dataset, execution

    start = time.monotonic()
    if notes:
        _note_loads(made)
    how = execution.Execution(
        workers=options.workers,
        threads=options.threads,
        scheduler=options.scheduler,
        chunks=folder / _CHUNKS if folder else None,
        resume=options.resume,
    )
    with watching.shown(title) as watch:
        found = execution.execute(dataset.chunks(made), how, watch)
    if how.chunks is None:
        return dataset.whole(made, found), time.monotonic() - start
    whole = how.chunks / f"{PARTIAL}{_STUDY}"
    dataset.write(made, found, whole)
    return dataset.opened(whole), time.monotonic() - start


def told_kept(studies: Sequence[tuple[Any, Path]]) -> str:
    """Says how many parts of studies their folders keep; "" for none."""
    from dynabot_mj.study import dataset, execution

    counts = [execution.kept(dataset.chunks(made), folder / _CHUNKS) for made, folder in studies]
    kept, whole = (sum(column) for column in zip(*counts, strict=True))
    return f"kept {kept} of {whole} parts" if kept else ""


@contextlib.contextmanager
def drafted(
    folder: ResultFolder, made: Any, dataset: Any, options: argparse.Namespace, wall_s: float
) -> Iterator[Path]:
    """Yields a folder for further results beside what every study leaves behind, and keeps them all at once."""
    from dynabot_mj import study
    from dynabot_mj.study.dataset import chunks
    from dynabot_mj.study.execution import forget

    execution = {
        "command": shlex.join(["dynabot", *sys.argv[1:]]),
        "folder": str(Path.cwd()),
        "workers": options.workers,
        "threads": options.threads,
        "wall_s": round(wall_s, 3),
        "cores": parsers.cores(),
    }
    with folder.drafted() as draft:
        if source := dataset.encoding.get("source"):
            shutil.copyfile(source, draft / _STUDY)  # figures still read it
        else:
            study.save(dataset, draft / _STUDY)
        (draft / "study.toml").write_text(made.text, encoding="utf-8")
        (draft / _EXECUTION).write_text(results.dump(execution), encoding="utf-8")
        yield draft
    dataset.close()
    (folder.path / _CHUNKS / f"{PARTIAL}{_STUDY}").unlink(missing_ok=True)
    forget(chunks(made), folder.path / _CHUNKS)


def _wall_s(folder: ResultFolder) -> float:
    """Returns how long the finished study took [s]."""
    execution = json.loads((folder.path / _EXECUTION).read_text(encoding="utf-8"))
    return float(execution["wall_s"])


def _note_loads(made: Any) -> None:
    """Says of each estimator, once, that its periods overload the processor."""
    from dynabot_mj.study import scenario

    told = set()
    for point in made.points:
        for estimator, load in scenario.loads(point.setup).items():
            if estimator not in told:
                told.add(estimator)
                note_load(estimator, load, point.setup.processor.utilisation)


def note_late(comparison: Any) -> None:
    """Says that a case was too short for its robots to arrive."""
    from dynabot_mj.experiments.formation import compare

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
