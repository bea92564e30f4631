"""How the work of a study is done: in chunks, on processes of this machine or on a cluster.

A chunk is a range of trials of one case. Its result depends on the configuration and the trials' numbers alone, so
neither the size of a study, nor the number of workers or threads, nor an interruption changes a single bit.
"""

import concurrent.futures
import contextlib
import functools
import hashlib
import pickle
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from dynabot_mj.common.arrays import Progress
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.host import files, opengl, processes
from dynabot_mj.plants.kinds import KINDS
from dynabot_mj.study import configuration, provenance, scenario
from dynabot_mj.study.assembly import simulate
from dynabot_mj.study.scenario import Case, Scenario
from dynabot_mj.trial.judge import Outcome

CHUNK = 50  # trials
RECORDED = 1  # trajectories kept of each case, from the study's first trial on


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


@dataclass(frozen=True, kw_only=True)
class _Chunk:
    """A unit of work."""

    setup: Scenario
    case: Case
    trials: range
    recorded: int
    threads: int

    @property
    def name(self) -> str:
        """A file name that only the same work has: whatever changes the result changes the name."""
        setup = configuration.dump(replace(self.setup, trials=1, first_trial=0))
        content = (
            setup,
            provenance.inputs(self.setup),
            provenance.versions(),
            provenance.source_digest(),
            asdict(self.case),
        )
        key = hashlib.sha256(repr((content, self.trials, self.recorded)).encode()).hexdigest()[:16]
        return f"{self.case.label.replace('/', '-')}-{self.trials.start}-{key}.pickle"

    @property
    def weight(self) -> float:
        """Rough seconds of work, for the estimate of the remaining time and the order of the chunks."""
        trial, robot = KINDS[self.case.plant].work
        per_trial = trial + robot * self.setup.robots
        events = 1e3 / scenario.periods(self.setup, self.case.estimator)[1]
        if self.case.perception == "filter":
            per_trial += 1e-5 * events * self.setup.robots
        return scenario.duration(self.setup) * (len(self.trials) * per_trial + events * 3e-4)


@dataclass
class _Tally:
    """Share of the work that is done, from the shares of the chunks."""

    weights: list[float]
    progress: Progress
    shares: list[float] = field(init=False)

    def __post_init__(self) -> None:
        self.shares = [0.0] * len(self.weights)

    def update(self, index: int, share: float) -> None:
        self.shares[index] = share
        done = sum(w * s for w, s in zip(self.weights, self.shares, strict=True))
        self.progress(done / sum(self.weights))


class CancelledError(Exception):
    """The study was interrupted while this chunk ran."""


def execute(setup: Scenario, how: Execution, progress: Progress) -> dict[Case, list[Outcome]]:
    """Runs all trials of all cases of a study.

    Args:
        setup: The study's configuration.
        how: How to execute it.
        progress: Called now and then.

    Returns:
        The outcomes of each case's chunks, in the order of their trials.
    """
    chunks = list(_chunks(setup, how.threads))
    tally = _Tally([chunk.weight for chunk in chunks], progress)
    outcomes: dict[int, Outcome] = {}
    if how.chunks is not None:
        how.chunks.mkdir(parents=True, exist_ok=True)
        files.sweep(how.chunks)
        kept = {file.name for file in how.chunks.iterdir()}
        if how.resume and kept and not kept & {chunk.name for chunk in chunks}:
            raise InputError(f"{how.chunks} holds parts of another study (or of another version); run without --resume")
        for index, chunk in enumerate(chunks):
            file = how.chunks / chunk.name
            if how.resume and file.is_file():
                outcomes[index] = pickle.loads(file.read_bytes())
                tally.update(index, 1.0)
    todo = {index: chunk for index, chunk in enumerate(chunks) if index not in outcomes}
    for index, outcome in _execute(todo, how, tally):
        outcomes[index] = outcome
        if how.chunks is not None:
            files.write(how.chunks / chunks[index].name, pickle.dumps(outcome))
        tally.update(index, 1.0)
    by_case: dict[Case, list[Outcome]] = {case: [] for case in scenario.cases(setup)}
    for index, chunk in enumerate(chunks):
        by_case[chunk.case].append(outcomes[index])
    return by_case


def forget(setup: Scenario, folder: Path) -> None:
    """Deletes the finished chunks of a study, and the folder where it holds nothing else."""
    for chunk in _chunks(setup, threads=1):
        (folder / chunk.name).unlink(missing_ok=True)
    with contextlib.suppress(OSError):
        folder.rmdir()


def kept(setup: Scenario, folder: Path) -> tuple[int, int]:
    """Returns how many finished chunks of a study a folder keeps, and how many the study has."""
    chunks = list(_chunks(setup, threads=1))
    present = {file.name for file in folder.iterdir()} if folder.is_dir() else set()
    return sum(chunk.name in present for chunk in chunks) if present else 0, len(chunks)


def _chunks(setup: Scenario, threads: int) -> Iterator[_Chunk]:
    first, end = setup.first_trial, setup.first_trial + setup.trials
    for case in scenario.cases(setup):
        for start in range(first, end, CHUNK):
            yield _Chunk(
                setup=setup,
                case=case,
                trials=range(start, min(start + CHUNK, end)),
                recorded=max(0, RECORDED - (start - first)),
                threads=threads,
            )


def _execute(todo: Mapping[int, _Chunk], how: Execution, tally: _Tally) -> Iterator[tuple[int, Outcome]]:
    """Yields the outcomes of the chunks as they finish."""
    if how.scheduler is None and (how.workers == 1 or len(todo) <= 1):
        for index, chunk in todo.items():
            yield index, _run_chunk(index, chunk, functools.partial(tally.update, index))
        return
    reports, stop = processes.context.SimpleQueue(), processes.context.Event()
    with contextlib.ExitStack() as stack:
        executor: concurrent.futures.Executor
        if how.scheduler is not None:
            executor = _dask_executor(how.scheduler, stack)
        else:
            executor = stack.enter_context(processes.pool(min(how.workers, len(todo)), reports, stop))
        # Long chunks first, so that no worker is left with one at the end.
        order = sorted(todo, key=lambda index: -todo[index].weight)
        with files.uninterrupted(), opengl.unasked():
            # Workers are started here and inherit that they ignore signals, which reach every process of a terminal or
            # of a batch job, and that they need no OpenGL.
            waiting = {executor.submit(_run_chunk, index, todo[index]): index for index in order}
        try:
            while waiting:
                done, _ = concurrent.futures.wait(waiting, 0.2, concurrent.futures.FIRST_COMPLETED)
                while not reports.empty():
                    tally.update(*reports.get())
                for future in done:
                    yield waiting.pop(future), future.result()
        except BaseException:
            stop.set()
            raise


def _dask_executor(address: str, stack: contextlib.ExitStack) -> concurrent.futures.Executor:
    """Returns an executor on the workers of a Dask cluster."""
    try:
        import distributed
    except ImportError as error:
        raise InputError("--scheduler needs Dask: pip install 'dynabot-mj[cluster]'") from error
    try:
        client = stack.enter_context(distributed.Client(address, timeout=10))
    except (OSError, ValueError) as error:
        raise InputError(f"no Dask scheduler answers at {address!r}") from error
    executor: concurrent.futures.Executor = client.get_executor()
    return executor


def _run_chunk(index: int, chunk: _Chunk, progress: Progress | None = None) -> Outcome:
    reported = 0.0

    def tell_parent(share: float) -> None:
        nonlocal reported
        if not (links := processes.links()):
            return
        reports, stop = links  # where to report the progress, and whether the study was interrupted
        if stop.is_set():
            raise CancelledError
        if share >= reported + 0.02:
            reported = share
            reports.put((index, share))

    return simulate(
        chunk.setup,
        chunk.case,
        chunk.trials,
        recorded=chunk.recorded,
        threads=chunk.threads,
        progress=progress or tell_parent,
    )
