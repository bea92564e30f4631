"""How long work is done: in chunks, on processes of this machine or on a cluster, interrupted and resumed.

A chunk is whatever can be computed by itself, such as a range of trials of one case. Its result depends on what its
`origin` says alone, so neither the size of the work, nor the number of workers or threads, nor the order in which
chunks finish, nor an interruption changes a single bit. Finished chunks are files of columns, see `chunk_files`.
"""

import concurrent.futures
import contextlib
import functools
import hashlib
import json
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from dynabot_mj.common.arrays import Progress
from dynabot_mj.common.columns import Columns
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.common.trees import flat
from dynabot_mj.host import files, opengl, processes
from dynabot_mj.study import chunk_files, provenance
from dynabot_mj.study.chunk_files import DamagedError

_TOLD = 3  # differences that a message names


@dataclass(frozen=True, kw_only=True)
class Execution:
    """How a study is executed; none of it changes the result.

    Attributes:
        workers: Processes of this machine; above 1, a script has to guard what it runs by
            `if __name__ == "__main__":`, since each of them imports it.
        threads: Of MuJoCo in each of them.
        scheduler: Address of a Dask scheduler, whose workers take the place of the processes.
        chunks: Folder that keeps finished chunks until the study is complete.
        resume: Take the finished chunks of an interrupted run from there.

    Example:
        >>> setup = dy.build_scenario({"trials": 2, "duration": 1.0, "plants": ["particle"], "estimators": ["gps"]})
        >>> dy.run(setup, dy.Execution(threads=2)).identical(dy.run(setup))
        True
    """

    workers: int = 1
    threads: int = 1
    scheduler: str | None = None
    chunks: Path | None = None
    resume: bool = False


class Chunk(Protocol):
    """A unit of work, which can be sent to another process."""

    @property
    def label(self) -> str:
        """Whose part it is, such as a case."""
        ...

    @property
    def start(self) -> int:
        """Where in it: the number of the first trial."""
        ...

    @property
    def weight(self) -> float:
        """Rough seconds of work, for the estimate of the remaining time and the order of the chunks."""
        ...

    @property
    def origin(self) -> Mapping[str, Any]:
        """What the result depends on, as plain values: equal origins, equal results."""
        ...

    def run(self, threads: int, progress: Progress) -> Columns:
        """Does it."""
        ...


class Watch:
    """Is told how the work goes, and does nothing about it."""

    def begin(self, chunks: Sequence[Chunk], kept: Collection[int]) -> None:
        """Takes what is to be done, and which of it is there from an earlier run."""

    def note(self, text: str) -> None:
        """Takes what a user should know."""

    def share(self, index: int, share: float) -> None:
        """Takes how much of a chunk is done."""

    def done(self, index: int, columns: Columns) -> None:
        """Takes the result of a chunk; those that were kept come first."""


class ShareWatch(Watch):
    """Tells the share of all the work that is done."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._weights, self._shares = [0.0], [0.0]

    def begin(self, chunks: Sequence[Chunk], kept: Collection[int]) -> None:
        """Weighs the chunks."""
        self._weights = [chunk.weight for chunk in chunks]
        self._shares = [0.0] * len(chunks)

    def share(self, index: int, share: float) -> None:
        """Tells of a chunk that goes on."""
        self._shares[index] = share
        done = sum(w * s for w, s in zip(self._weights, self._shares, strict=True))
        self._progress(done / sum(self._weights))

    def done(self, index: int, columns: Columns) -> None:
        """Tells of a chunk that is whole."""
        self.share(index, 1.0)


class Results:
    """Of all chunks by their index: in memory, or, so that memory does not grow with the work, in files."""

    def __init__(self, folder: Path | None, names: Sequence[str]) -> None:
        self._folder, self._names = folder, names
        self._here: dict[int, Columns] = {}

    def __getitem__(self, index: int) -> Columns:
        if self._folder is None:
            return self._here[index]
        return chunk_files.parse((self._folder / self._names[index]).read_bytes())[0]

    def put(self, index: int, columns: Columns, origin: Mapping[str, Any]) -> None:
        """Takes the result of a chunk."""
        if self._folder is None:
            self._here[index] = columns
        else:
            files.write(self._folder / self._names[index], chunk_files.content(columns, origin))


class CancelledError(Exception):
    """The work was interrupted while this chunk ran."""


def execute(chunks: Sequence[Chunk], how: Execution, watch: Watch) -> Results:
    """Does all chunks, or those of them that an earlier run has not left whole.

    Args:
        chunks: The work.
        how: How to execute it.
        watch: Is told how it goes.

    Raises:
        InputError: If there is nothing of this work to resume, or the cluster cannot do it.
    """
    results = Results(how.chunks, _names(chunks) if how.chunks else ())
    there: set[int] = set()
    notes: list[str] = []
    if how.chunks is not None:
        how.chunks.mkdir(parents=True, exist_ok=True)
        files.sweep(how.chunks)
        if how.resume:
            there, notes = _whole(how.chunks, chunks)
    watch.begin(chunks, there)
    for note in notes:
        watch.note(note)
    for index in sorted(there):
        watch.done(index, results[index])
    todo = {index: chunk for index, chunk in enumerate(chunks) if index not in there}
    for index, columns in _execute(todo, how, watch):
        results.put(index, columns, chunks[index].origin)
        watch.done(index, columns)
    return results


def forget(chunks: Sequence[Chunk], folder: Path) -> None:
    """Deletes finished chunks, and the folder where it holds nothing else."""
    for name in _names(chunks):
        (folder / name).unlink(missing_ok=True)
    with contextlib.suppress(OSError):
        folder.rmdir()


def kept(chunks: Sequence[Chunk], folder: Path) -> tuple[int, int]:
    """Returns how many of some chunks a folder keeps, and how many there are."""
    present = {file.name for file in folder.iterdir()} if folder.is_dir() else set()
    return sum(name in present for name in _names(chunks)) if present else 0, len(chunks)


def _names(chunks: Sequence[Chunk]) -> list[str]:
    """Returns the names of chunks' files: whatever changes a result changes its name."""
    found = []
    for chunk in chunks:
        key = hashlib.sha256(json.dumps(chunk.origin, sort_keys=True).encode()).hexdigest()[:16]
        label = "".join(letter if letter.isalnum() or letter in "-_.=" else "-" for letter in chunk.label)
        found.append(f"{label[:100]}-{chunk.start}-{key}{chunk_files.SUFFIX}")
    return found


def _whole(folder: Path, chunks: Sequence[Chunk]) -> tuple[set[int], list[str]]:
    """Returns which chunks a folder has whole, and what is to be said of its other files.

    Raises:
        InputError: If it has parts of other work alone.
    """
    names = {name: index for index, name in enumerate(_names(chunks))}
    whole, damaged, foreign = set(), [], []
    for file in sorted(folder.glob(f"*{chunk_files.SUFFIX}")):
        try:
            _, origin = chunk_files.parse(file.read_bytes())
        except DamagedError as error:
            damaged.append(f"{file.name} is damaged ({error})")
            continue
        index = names.get(file.name)
        if index is not None and origin == _plain(chunks[index].origin):
            whole.add(index)
        else:
            nearest = chunks[index or 0].origin
            foreign.append(f"{file.name} ({_differing(origin, _plain(nearest))})")
    if foreign and not whole and not damaged:
        raise InputError(
            f"{folder} holds parts of another study (or of another version): {foreign[0]}; run without --resume"
        )
    notes = [f"{one}; it is computed again" for one in damaged]
    if foreign:
        more = f" and {len(foreign) - 1} more" if len(foreign) > 1 else ""
        notes.append(f"not of this study and not used: {foreign[0]}{more}")
    return whole, notes


def _plain(origin: Mapping[str, Any]) -> Any:
    return json.loads(json.dumps(origin))


def _differing(there: Mapping[str, Any], here: Mapping[str, Any]) -> str:
    """Says in what two origins differ."""
    one, other = dict(flat(there)), dict(flat(here))
    names = [name for name in {**one, **other} if one.get(name) != other.get(name)]
    told = ", ".join(
        f"{name} {one.get(name, 'nothing')} there and {other.get(name, 'nothing')} here" for name in names[:_TOLD]
    )
    return told + (f", and {len(names) - _TOLD} more" if len(names) > _TOLD else "")


def _execute(todo: Mapping[int, Chunk], how: Execution, watch: Watch) -> Iterator[tuple[int, Columns]]:
    """Yields the results of the chunks as they finish."""
    if how.scheduler is None and (how.workers == 1 or len(todo) <= 1):
        for index, chunk in todo.items():
            yield index, chunk.run(how.threads, functools.partial(watch.share, index))
        return
    reports, stop = processes.context.SimpleQueue(), processes.context.Event()
    with contextlib.ExitStack() as stack:
        executor: concurrent.futures.Executor
        expected = None
        if how.scheduler is not None:
            executor, expected = stack.enter_context(_cluster(how.scheduler)), provenance.computation()
        else:
            executor = stack.enter_context(processes.pool(min(how.workers, len(todo)), reports, stop))
        # Long chunks first, so that no worker is left with one at the end.
        order = sorted(todo, key=lambda index: -todo[index].weight)
        with files.uninterrupted(), opengl.unasked():
            # Workers are started here and inherit that they ignore signals, which reach every process of a terminal or
            # of a batch job, and that they need no OpenGL.
            waiting = {executor.submit(_run, index, todo[index], how.threads, expected): index for index in order}
        try:
            while waiting:
                done, _ = concurrent.futures.wait(waiting, 0.2, concurrent.futures.FIRST_COMPLETED)
                while not reports.empty():
                    watch.share(*reports.get())
                for future in done:
                    yield waiting.pop(future), future.result()
        except BaseException:
            stop.set()
            raise


@contextlib.contextmanager
def _cluster(address: str) -> Iterator[concurrent.futures.Executor]:
    """Yields an executor on the workers of a Dask cluster, all of which compute as this process does.

    Raises:
        InputError: If there is no such cluster, it has no workers, or they would compute something else.
    """
    try:
        import distributed
    except ImportError as error:
        raise InputError("--scheduler needs Dask: pip install 'dynabot-mj[cluster]'") from error
    try:
        client = distributed.Client(address, timeout=10)
    except (OSError, ValueError) as error:
        raise InputError(f"no Dask scheduler answers at {address!r}") from error
    with client:
        here = provenance.computation()
        try:
            found = client.run(provenance.computation)
        except OSError:
            raise
        except Exception as error:  # of any kind: that of a worker which cannot import us is a bare one of its text
            why = str(error) or type(error).__name__
            raise InputError(
                f"the Dask workers at {address!r} cannot say by what they compute; can they import dynabot_mj? {why}"
            ) from error
        if not found:
            raise InputError(f"the Dask scheduler at {address!r} has no workers; start some: dask worker {address}")
        for worker, there in found.items():
            if there != here:
                raise InputError(f"the Dask worker {worker} would compute otherwise: {_differing(there, here)}")
        yield client.get_executor()


def _run(index: int, chunk: Chunk, threads: int, expected: Mapping[str, str] | None) -> Columns:
    """Does a chunk in a worker."""
    reported = 0.0
    if expected is not None and (here := provenance.computation()) != expected:  # a worker that has joined since
        raise InputError(f"a Dask worker would compute otherwise: {_differing(here, expected)}")

    def tell_parent(share: float) -> None:
        nonlocal reported
        if not (links := processes.links()):
            return
        reports, stop = links  # where to report the progress, and whether the work was interrupted
        if stop.is_set():
            raise CancelledError
        if share >= reported + 0.02:
            reported = share
            reports.put((index, share))

    return chunk.run(threads, tell_parent)
