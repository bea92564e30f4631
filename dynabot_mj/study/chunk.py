"""A unit of work that can be computed by itself, in any process: what it does, and what its result depends on."""

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from dynabot_mj.common.arrays import Progress
from dynabot_mj.common.columns import Columns
from dynabot_mj.study import chunk_files, provenance


@dataclass(frozen=True, kw_only=True)
class Chunk:
    """Some trials of a case, some runs, or whatever else is one call of a function."""

    label: str  # whose part it is, such as a case
    start: int = 0  # where in it: the number of the first trial
    size: int = 1  # how much of it: trials
    weight: float = 1.0  # rough seconds of work beside other chunks, for the remaining time and the order
    inputs: Mapping[str, Any]  # what the result depends on beside the code, as plain values
    work: Callable[..., Columns]  # of a module; called with the arguments, and with `threads` and `progress`
    arguments: tuple[Any, ...]

    @property
    def origin(self) -> dict[str, Any]:
        """What the result depends on: equal origins, equal results."""
        return {**self.inputs, "computation": provenance.computation()}

    @property
    def file_name(self) -> str:
        """Of the finished chunk: whatever changes the result changes the name."""
        key = hashlib.sha256(json.dumps(self.origin, sort_keys=True).encode()).hexdigest()[:16]
        label = "".join(letter if letter.isalnum() or letter in "-_.=" else "-" for letter in self.label)
        return f"{label[:100]}-{self.start}-{key}{chunk_files.SUFFIX}"

    def run(self, threads: int, progress: Progress) -> Columns:
        """Does it.

        Args:
            threads: Of MuJoCo.
            progress: Told the share that is done.
        """
        return self.work(*self.arguments, threads=threads, progress=progress)
