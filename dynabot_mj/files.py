"""Writing results: whole or not at all, and refusing early where it is not possible."""

import contextlib
import os
import shutil
import signal
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path

from dynabot_mj.errors import InputError

# Signals by which a user, a batch system or a closed terminal ends us.
ENDING = {getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)}
_LIST = ".results"  # names of the files of the latest results in a folder


def require_writable(folder: Path) -> None:
    """Makes sure of an output folder by really creating it and a file in it, before any work.

    Raises:
        InputError: If that fails.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        reason = "it is not a folder" if folder.is_file() else error.strerror
        raise InputError(f"cannot write to the folder {folder}: {reason}") from error


def write(path: Path, content: bytes) -> None:
    """Writes a file beside its place and renames it into place."""
    partial = path.with_name(f".{path.name}.partial")
    try:
        partial.write_bytes(content)
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)


@contextlib.contextmanager
def uninterrupted() -> Iterator[None]:
    """Puts signals that end us off to the end of a moment that must not be cut in two.

    Processes started meanwhile never get them: they are told by their parent.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread is interrupted
        return
    came: list[int] = []
    # The handlers hold them back here, whichever thread the system picks; the mask is what child processes inherit.
    handlers = {one: signal.signal(one, lambda number, frame: came.append(number)) for one in ENDING}
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING) if hasattr(signal, "pthread_sigmask") else None
    try:
        yield
    finally:
        for one, handler in handlers.items():
            signal.signal(one, handler)
        if mask is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
    if came:
        signal.raise_signal(came[0])


@contextlib.contextmanager
def staged(folder: Path) -> Iterator[Path]:
    """Yields a folder to write results into; they replace those in `folder` only when all of them are complete.

    A list of what was written stays beside the results, so that the next ones replace all of them and nothing else.
    """
    stage = Path(tempfile.mkdtemp(prefix=".partial-", dir=folder))
    try:
        yield stage
        written = sorted(file.name for file in stage.iterdir())
        (stage / _LIST).write_text("\n".join(written) + "\n", encoding="utf-8")
        with uninterrupted():
            if (folder / _LIST).is_file():
                earlier = (folder / _LIST).read_text(encoding="utf-8").split("\n")
                for name in {Path(name).name for name in earlier if name} - set(written):
                    (folder / name).unlink(missing_ok=True)
            for name in [*written, _LIST]:
                os.replace(stage / name, folder / name)
    finally:
        shutil.rmtree(stage, ignore_errors=True)
