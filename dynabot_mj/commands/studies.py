"""What commands that run a study share: its folder, the run with progress, and what it leaves behind."""

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
from dynabot_mj.host.files import PARTIAL
from dynabot_mj.host.result_folder import ResultFolder

_CHUNKS = ".chunks"  # finished parts of a study, until it is complete
_STUDY, _EXECUTION = "study.nc", "execution.json"
_FILES = (_STUDY, "study.toml", _EXECUTION)  # of every study


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
    from dynabot_mj.study import provenance, trial_chunks

    told = kept or (lambda folder: told_kept([(trial_chunks.chunks(made), folder)]))
    depends_on = provenance.depends_on(made.first) | made.grid_values
    with _resumable(options, name, depends_on, (*_FILES, *names), told) as folder:
        yield folder


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
    from dynabot_mj.study import chunk_folder

    with _resumable(options, name, depends_on, names, lambda folder: told_kept([(chunks, folder)])) as folder:
        how = _execution(options, folder.path)
        yield folder, how
        chunk_folder.forget(how.chunks, chunks)


@contextlib.contextmanager
def _resumable(
    options: argparse.Namespace,
    name: str,
    depends_on: Mapping[str, Any],
    names: Sequence[str],
    told: Callable[[Path], str],
) -> Iterator[ResultFolder]:
    """Opens a folder of results, and says which parts are there to resume, and which an early end leaves."""
    with results.opened(options, name, depends_on, names, told) as folder:
        if options.resume and (found := told(folder.path)):
            print(f"note: {found}", file=sys.stderr)
        try:
            yield folder
        except BaseException:  # the command's last line tells what outlives it
            options.kept = told(folder.path)
            raise


def _execution(options: argparse.Namespace, folder: Path | None) -> Any:
    """Returns how a command's work is executed."""
    from dynabot_mj.study.execution import Execution

    return Execution(
        workers=options.workers,
        threads=getattr(options, "threads", 1),
        scheduler=options.scheduler,
        chunks=folder / _CHUNKS if folder else None,
        resume=options.resume,
    )


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
    from dynabot_mj.study import dataset, execution, layout, trial_chunks

    start = time.monotonic()
    if notes:
        _note_loads(made)
    how = _execution(options, folder)
    with watching.shown(title) as watch:
        found = execution.execute(trial_chunks.chunks(made), how, watch)
    if how.chunks is None:
        return dataset.whole(made, found), time.monotonic() - start
    whole = how.chunks / f"{PARTIAL}{_STUDY}"
    layout.write(made, found, whole)
    return dataset.opened(whole), time.monotonic() - start


def told_kept(work: Sequence[tuple[Sequence[Any], Path]]) -> str:
    """Says how many chunks of works the folders of their results keep; "" for none."""
    from dynabot_mj.study import chunk_folder

    kept = sum(chunk_folder.kept(folder / _CHUNKS, chunks) for chunks, folder in work)
    return f"kept {kept} of {sum(len(chunks) for chunks, _ in work)} parts" if kept else ""


@contextlib.contextmanager
def drafted(
    folder: ResultFolder, made: Any, dataset: Any, options: argparse.Namespace, wall_s: float
) -> Iterator[Path]:
    """Yields a folder for further results beside what every study leaves behind, and keeps them all at once."""
    from dynabot_mj import study
    from dynabot_mj.study import chunk_folder, trial_chunks

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
    chunk_folder.forget(folder.path / _CHUNKS, trial_chunks.chunks(made))


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
