"""Worker processes that live no longer than their parent, and what is said when one dies before its work is done."""

import concurrent.futures
import contextlib
import multiprocessing
import os
import threading
import time
from collections.abc import Iterator
from concurrent.futures.process import BrokenProcessPool
from typing import Any

from dynabot_mj.common.exceptions import DynabotError

_POLL = 0.5  # how often a worker looks whether its parent still lives [s]


class WorkerDiedError(DynabotError):
    """A worker process ended before its work was done."""


# A new interpreter per worker: forking a process that runs MuJoCo's threads is unsafe.
context = multiprocessing.get_context("spawn")


@contextlib.contextmanager
def pool(workers: int, *shared: Any) -> Iterator[concurrent.futures.ProcessPoolExecutor]:
    """Yields an executor on processes of this machine.

    Submit under `files.uninterrupted`, so that workers inherit that signals are the parent's to take.

    Args:
        workers: Number of processes.
        shared: Multiprocessing objects that workers may take from `links`.

    Raises:
        WorkerDiedError: If a worker dies.
    """
    _refuse_workers_of_workers()
    begun = context.Event()
    executor = concurrent.futures.ProcessPoolExecutor(workers, context, _start, (os.getpid(), begun, shared))
    try:
        yield executor
    except BrokenProcessPool:
        raise WorkerDiedError(_obituary(begun.is_set())) from None
    finally:
        # A worker that still starts needs our semaphores.
        executor.shutdown(wait=True, cancel_futures=True)


def links() -> tuple[Any, ...]:
    """Returns what the parent shares with this worker; nothing in a process that is none."""
    return _links


_links: tuple[Any, ...] = ()


def _start(parent: int, begun: Any, shared: tuple[Any, ...]) -> None:
    """Prepares a worker."""
    global _links
    _links = shared
    begun.set()
    threading.Thread(target=_outlive_not, args=(parent,), daemon=True).start()


def _outlive_not(parent: int) -> None:
    """Ends this process when its parent is gone, whatever that died of: nobody would take the result."""
    while os.getppid() == parent:
        time.sleep(_POLL)
    os._exit(1)


def _obituary(begun: bool) -> str:
    if not begun:
        return (
            "a worker process died before it began; a script that uses several workers needs its own work below "
            "`if __name__ == '__main__':`"
        )
    return "a worker process died (killed, perhaps for want of memory); run again with resume (--resume) to continue"


def _refuse_workers_of_workers() -> None:
    """Ends a worker quietly that would start workers itself while it imports a script without a main guard."""
    if getattr(multiprocessing.current_process(), "_inheriting", False):
        raise SystemExit(1)
