"""Code of the user's, `my_module:name`: how it is found, and what is told of it where it fails."""

import contextlib
import importlib
import sys
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from dynabot_mj.common.exceptions import InputError


def load(what: str, name: str, allowed: str, kind: str = "a function") -> Any:
    """Returns what a name of the user's means.

    Args:
        what: It is, for the messages, e.g. `controller 'mine:law'`.
        name: `my_module:name`; the module is looked for in the working directory too.
        allowed: What else would be allowed, for the messages.
        kind: Of thing that it must be, for the messages; it must be callable.

    Raises:
        InputError: If there is no such thing.
    """
    module_name, _, attribute = name.partition(":")
    if not module_name or not attribute:
        raise InputError(f"{what} given, it must be {allowed}")
    here = str(Path.cwd())
    if here not in sys.path:
        sys.path.insert(0, here)  # commands, and their worker processes, start without it
    try:
        with contextlib.redirect_stdout(sys.stderr):
            found = getattr(importlib.import_module(module_name), attribute)
    except AttributeError as error:
        raise InputError(f"{what} given: {error}") from error
    except Exception as error:  # whatever happens in a module of the user's
        raise InputError(f"{what} cannot be imported: {told(error)}") from error
    if not callable(found):
        raise InputError(f"{what} given, it must be {kind}")
    return found


def look_in(folder: Path | None) -> None:
    """Lets modules be found in a folder too, behind the working directory."""
    if folder is not None and str(folder) not in sys.path:
        sys.path.append(str(folder))


def source(found: Any) -> Path | None:
    """Returns the file that a thing of the user's is from; None where there is no file."""
    # What is built into Python, and what is no function but can be called, may be of no module.
    file = getattr(sys.modules.get(getattr(found, "__module__", None) or ""), "__file__", None)
    return Path(file) if file else None


@contextlib.contextmanager
def called(what: str) -> Iterator[None]:
    """Runs code of the user's: what it prints goes to stderr, since where our own results go is no place for it.

    Args:
        what: Is called, for the message.

    Raises:
        InputError: If it fails, in one line that says where in it.
    """
    try:
        with contextlib.redirect_stdout(sys.stderr):
            yield
    except Exception as error:  # it is the user's: anything
        raise InputError(f"{what}: {told(error)}") from error


def told(error: Exception) -> str:
    """Returns an error of the user's code in one line, and where in it."""
    where = traceback.extract_tb(error.__traceback__)[-1]
    reason = " ".join(str(error).split())
    return f"{type(error).__name__}{f': {reason}' if reason else ''} ({Path(where.filename).name}, line {where.lineno})"
