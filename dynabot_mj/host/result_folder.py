"""A folder of results: whose they are, what may be replaced in it, and one command at a time that works there.

Beside its results a folder keeps a list of them and of what they depend on. Whatever is not on that list is the user's
and is never touched; what is on it goes together.
"""

import contextlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from dynabot_mj.common import trees
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.host import files

WAIT = 10.0  # for another command that works in the folder [s]

_LIST = ".results"
_LOCK = ".lock"


@dataclass(frozen=True, kw_only=True)
class Contents:
    """Whose results a folder holds."""

    command: str  # that makes them
    options: Mapping[str, Any]  # what they depend on, as plain values: equal options, equal results
    files: Sequence[str] = ()  # relative to the folder


class ResultFolder:
    """A folder that is ours to write to until the command ends; made by `opened`."""

    def __init__(self, path: Path, contents: Contents, earlier: Contents | None) -> None:
        self.path = path
        self.earlier = earlier  # what it holds; None: nothing of ours
        self.contents = contents

    @property
    def same(self) -> bool:
        """Whether it holds results that these would be equal to."""
        return self.earlier is not None and not difference(self.earlier, self.contents)

    @property
    def whole(self) -> bool:
        """Whether it holds these very results, none of them missing."""
        return (
            self.earlier is not None and self.same and all((self.path / name).is_file() for name in self.earlier.files)
        )

    @contextlib.contextmanager
    def drafted(self) -> Iterator[Path]:
        """Yields a folder to write results into; they replace those in this one only when all of them are complete.

        The names are those that `opened` was told, so that none of the user's files has to make room in the end.
        """
        draft = Path(tempfile.mkdtemp(prefix=files.PARTIAL, dir=self.path))
        try:
            yield draft
            written = sorted(file.name for file in draft.iterdir())
            if unknown := [name for name in written if not _any_matches(name, self.contents.files)]:
                raise AssertionError(f"results that were not announced: {', '.join(unknown)}")
            earlier = set(self.earlier.files if self.earlier else ())
            with files.uninterrupted():
                # Whatever ends us from here on, all of these are ours, and none of them is taken for a whole study.
                mixed = sorted(earlier | set(written))
                _list(self.path, Contents(command=self.contents.command, options={}, files=mixed))
                for name in earlier - set(written):
                    _remove(self.path, name)
                for name in written:
                    os.replace(draft / name, self.path / name)
                _list(self.path, Contents(**{**asdict(self.contents), "files": written}))
        finally:
            shutil.rmtree(draft, ignore_errors=True)


@contextlib.contextmanager
def opened(path: Path, contents: Contents, *, keep: bool) -> Iterator[ResultFolder]:
    """Makes sure of a folder before any work, and yields it; no other command may work in it meanwhile.

    Args:
        path: The folder; it is made where there is none.
        contents: What will be written. Its files are patterns.
        keep: Whether to refuse to replace other results.

    Raises:
        InputError: If it cannot be written to, holds other results that are to be kept or files of the user's under our
            names, or another command works in it for longer than `WAIT`.
    """
    files.require_writable(path)
    with locked(path):
        files.sweep(path)
        folder = ResultFolder(path, contents, _listed(path))
        require_ours(path, *contents.files)
        if keep and folder.earlier is not None and not folder.same:
            raise InputError(f"{path} holds {different(folder.earlier, contents)}; --overwrite replaces it")
        yield folder


@contextlib.contextmanager
def locked(place: Path) -> Iterator[None]:
    """Keeps other commands out of a place by a lock that the system frees when this process ends, whatever it dies of.

    Args:
        place: A folder, or a file in one that may be shared.

    Raises:
        InputError: If another command works there for longer than `WAIT`.
    """
    import filelock  # takes its time

    name = place / _LOCK if place.is_dir() else place.with_name(f"{_LOCK}-{files.short(place.name)}")
    lock = filelock.FileLock(name, timeout=WAIT)
    try:
        lock.acquire()
        while not name.exists():  # it was the lock of the one before, who took it away
            lock.release()
            lock.acquire()
    except filelock.Timeout:
        raise InputError(f"another command works at {place}; it has not ended within {WAIT:g} s") from None
    try:
        yield
    finally:
        name.unlink(missing_ok=True)
        lock.release()


def attach(folder: Path, names: Sequence[str]) -> None:
    """Adds files to the results of a folder, which go with them from then on."""
    earlier = _listed(folder) or Contents(command="", options={})
    _list(folder, Contents(**{**asdict(earlier), "files": sorted({*earlier.files, *names})}))


def require_ours(folder: Path, *patterns: str) -> None:
    """Makes sure that writing results takes the place of none of the user's files.

    Args:
        folder: Of the results.
        patterns: Of their names.

    Raises:
        InputError: If there is a file of such a name that is not on the list of results.
    """
    earlier = _listed(folder)
    ours = earlier.files if earlier else ()
    for file in (file for pattern in patterns for file in sorted(folder.glob(pattern))):
        if file.relative_to(folder).as_posix() not in ours:
            raise InputError(f"{file} is in the place of our results and none of them; move it, or take another folder")


def different(earlier: Contents, contents: Contents) -> str:
    """Says what a folder holds in place of the results that are asked for."""
    if earlier.command != contents.command:
        return f"results of {earlier.command or 'another version'}"
    return f"another {earlier.command} ({trees.told(difference(earlier, contents))})"


def difference(earlier: Contents, contents: Contents) -> dict[str, tuple[Any, Any]]:
    """Returns in what two differ, by dotted name; empty where they are alike."""
    if earlier.command != contents.command:
        return {"command": (earlier.command, contents.command)}
    there, here = (json.loads(json.dumps(one.options)) for one in (earlier, contents))
    return trees.differences(there, here)


def _any_matches(name: str, patterns: Sequence[str]) -> bool:
    return any(PurePosixPath(name).match(pattern) for pattern in patterns)


def _list(folder: Path, contents: Contents) -> None:
    files.write(folder / _LIST, json.dumps(asdict(contents), indent=1).encode())


def _listed(folder: Path) -> Contents | None:
    """Returns what the list of a folder says; None where there is no list, or nothing of it is there any more."""
    try:
        text = (folder / _LIST).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return None
    try:
        found = Contents(**json.loads(text))
    except (ValueError, TypeError):  # of an older version: names, one to a line
        found = Contents(command="", options={}, files=text.split("\n"))
    names = [name for name in found.files if name and _is_inside(name)]
    if not any((folder / name).is_file() for name in names):
        return None
    return Contents(command=found.command, options=found.options, files=names)


def _is_inside(name: str) -> bool:
    """Tells whether a name on a list stays in its folder: who edits the list must not make us delete elsewhere."""
    path = PurePosixPath(name)
    return not path.is_absolute() and ".." not in path.parts


def _remove(folder: Path, name: str) -> None:
    """Deletes a result, and the folder that held it where nothing else is in it."""
    (folder / name).unlink(missing_ok=True)
    for parent in PurePosixPath(name).parents[:-1]:
        with contextlib.suppress(OSError):
            (folder / parent).rmdir()
