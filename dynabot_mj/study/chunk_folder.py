"""Finished chunks until all are finished: in memory, or in a folder from which an interrupted study goes on."""

import contextlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dynabot_mj.common import trees
from dynabot_mj.common.columns import Columns
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.host import files
from dynabot_mj.study import chunk_files
from dynabot_mj.study.chunk import Chunk
from dynabot_mj.study.chunk_files import DamagedError


class Results:
    """Of chunks by their index: in memory, or, so that memory does not grow with the work, in files."""

    def __init__(self, chunks: Sequence[Chunk], folder: Path | None) -> None:
        self._chunks, self._folder = chunks, folder
        self._here: dict[int, Columns] = {}

    def __getitem__(self, index: int) -> Columns:
        if self._folder is None:
            return self._here[index]
        return chunk_files.parse((self._folder / self._chunks[index].file_name).read_bytes())[0]

    def put(self, index: int, columns: Columns) -> None:
        """Takes the result of a chunk."""
        if self._folder is None:
            self._here[index] = columns
        else:
            chunk = self._chunks[index]
            files.write(self._folder / chunk.file_name, chunk_files.content(columns, chunk.origin))


def whole(folder: Path, chunks: Sequence[Chunk]) -> tuple[set[int], list[str]]:
    """Returns which chunks a folder has whole, and what is to be said of its other files.

    Raises:
        InputError: If it has parts of other work alone.
    """
    names = {chunk.file_name: index for index, chunk in enumerate(chunks)}
    found, damaged, foreign = set(), [], []
    for file in sorted(folder.glob(f"*{chunk_files.SUFFIX}")):
        try:
            _, origin = chunk_files.parse(file.read_bytes())
        except DamagedError as error:
            damaged.append(f"{file.name} is damaged ({error})")
            continue
        index = names.get(file.name)
        if index is not None and origin == _plain(chunks[index].origin):
            found.add(index)
        else:
            nearest = _plain(chunks[index or 0].origin)
            foreign.append(f"{file.name} ({trees.told(trees.differences(origin, nearest))})")
    if foreign and not found and not damaged:
        raise InputError(
            f"{folder} holds parts of another study (or of another version): {foreign[0]}; run without --resume"
        )
    notes = [f"{one}; it is computed again" for one in damaged]
    if foreign:
        more = f" and {len(foreign) - 1} more" if len(foreign) > 1 else ""
        notes.append(f"not of this study and not used: {foreign[0]}{more}")
    return found, notes


def kept(folder: Path, chunks: Sequence[Chunk]) -> int:
    """Returns how many of some chunks a folder keeps."""
    present = {file.name for file in folder.iterdir()} if folder.is_dir() else set()
    return sum(chunk.file_name in present for chunk in chunks) if present else 0


def forget(folder: Path, chunks: Sequence[Chunk]) -> None:
    """Deletes finished chunks, and the folder where it holds nothing else."""
    for chunk in chunks:
        (folder / chunk.file_name).unlink(missing_ok=True)
    with contextlib.suppress(OSError):
        folder.rmdir()


def _plain(origin: Mapping[str, Any]) -> Any:
    return json.loads(json.dumps(origin))
