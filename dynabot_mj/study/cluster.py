"""The workers of a Dask cluster in place of this machine's processes; all of them compute as this process does."""

import concurrent.futures
import contextlib
from collections.abc import Iterator, Mapping

from dynabot_mj.common import trees
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.study import provenance


@contextlib.contextmanager
def connected(address: str) -> Iterator[concurrent.futures.Executor]:
    """Yields an executor on a cluster's workers.

    Args:
        address: Of the scheduler.

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
            require_alike(f"the Dask worker {worker}", there, provenance.computation())
        yield client.get_executor()


def require_alike(what: str, there: Mapping[str, str], here: Mapping[str, str]) -> None:
    """Makes sure that a worker computes as the process that asks it.

    Args:
        what: The worker, for the message.
        there: Its `provenance.computation`.
        here: That of the process that asks.

    Raises:
        InputError: If they differ.
    """
    if there != here:
        raise InputError(f"{what} would compute otherwise: {trees.told(trees.differences(there, here))}")
