"""How long work is done: in chunks, on processes of this machine or on a cluster, interrupted and resumed.

The result of a chunk depends on what its `origin` says alone, so neither the size of the work, nor the number of
workers or threads, nor the order in which chunks finish, nor an interruption changes a single bit.
"""

import concurrent.futures
import contextlib
import functools
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from dynabot_mj.common.arrays import Progress
from dynabot_mj.common.columns import Columns
from dynabot_mj.host import files, opengl, processes
from dynabot_mj.study import chunk_folder, cluster, provenance
from dynabot_mj.study.chunk import Chunk
from dynabot_mj.study.chunk_folder import Results


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
        self._weights: list[float] = []
        self._shares: list[float] = []
        self._done, self._total = 0.0, 1.0  # weight

    def begin(self, chunks: Sequence[Chunk], kept: Collection[int]) -> None:
        """Weighs the chunks."""
        self._weights, self._shares = [chunk.weight for chunk in chunks], [0.0] * len(chunks)
        self._done, self._total = 0.0, sum(self._weights) or 1.0

    def share(self, index: int, share: float) -> None:
        """Tells of a chunk that goes on."""
        self._done += self._weights[index] * (share - self._shares[index])
        self._shares[index] = share
        self._progress(self.whole)

    def done(self, index: int, columns: Columns) -> None:
        """Tells of a chunk that is whole."""
        self.share(index, 1.0)

    @property
    def whole(self) -> float:
        """Share of all the work that is done."""
        return min(self._done / self._total, 1.0)


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
    results = Results(chunks, how.chunks)
    there: set[int] = set()
    notes: list[str] = []
    if how.chunks is not None:
        how.chunks.mkdir(parents=True, exist_ok=True)
        files.sweep(how.chunks)
        if how.resume:
            there, notes = chunk_folder.whole(how.chunks, chunks)
    watch.begin(chunks, there)
    for note in notes:
        watch.note(note)
    for index in sorted(there):
        watch.done(index, results[index])
    todo = {index: chunk for index, chunk in enumerate(chunks) if index not in there}
    for index, columns in _execute(todo, how, watch):
        results.put(index, columns)
        watch.done(index, columns)
    return results


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
            executor, expected = stack.enter_context(cluster.connected(how.scheduler)), provenance.computation()
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


def _run(index: int, chunk: Chunk, threads: int, expected: Mapping[str, str] | None) -> Columns:
    """Does a chunk in a worker."""
    reported = 0.0
    if expected is not None:  # of a cluster, which workers may have joined since
        cluster.require_alike("a Dask worker", provenance.computation(), expected)

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
