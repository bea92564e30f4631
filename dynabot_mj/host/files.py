"""Writing results: whole or not at all, and refusing early where it is not possible."""

import contextlib
import hashlib
import os
import secrets
import shutil
import signal
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path

from dynabot_mj.common.exceptions import InputError

PARTIAL = ".partial-"  # start of the names of what is not complete yet
# Signals by which a user, a batch system or a closed terminal ends us.
ENDING = {getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)}


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
        reason = error.strerror
        with contextlib.suppress(OSError):  # a name too long for the system cannot even be asked for
            if folder.is_symlink() and not folder.exists():
                reason = f"it is a link to {os.readlink(folder)}, which is not there"
            elif folder.exists() and not folder.is_dir():
                reason = "it is not a folder"
        raise InputError(f"cannot write to the folder {folder}: {reason}") from error


def write(path: Path, content: bytes) -> None:
    """Writes a file beside its place and renames it into place."""
    partial = path.with_name(f"{PARTIAL}{os.getpid()}-{secrets.token_hex(4)}")
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


def sweep(folder: Path) -> None:
    """Deletes what commands that were killed left incomplete in a folder, which must be this process's alone."""
    for left in folder.glob(f"{PARTIAL}*"):
        if left.is_dir():
            shutil.rmtree(left, ignore_errors=True)
        else:
            left.unlink(missing_ok=True)


def short(name: str) -> str:
    """Returns a short name for a file name, for what stands beside it: the system limits how long names are."""
    return hashlib.sha256(name.encode(errors="surrogateescape")).hexdigest()[:8]
