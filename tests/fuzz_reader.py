"""Reads the files that `test_fuzz.py` makes, in a process of its own: a library that crashes or hangs ends it alone.

Every line that comes in is a kind and a path; every line that goes out says in JSON what came of it.
"""

import contextlib
import faulthandler
import json
import os
import resource
import sys
import traceback
from pathlib import Path

from dynabot_mj.common.exceptions import DynabotError
from dynabot_mj.plants import scene
from dynabot_mj.sensing.logs import log
from dynabot_mj.study import chunk_files, configuration, fleet, saved

_MEMORY = 8 * 2**30  # a file that asks for more must not take the machine down [bytes]


def _study(path: Path) -> None:
    study, _ = saved.load(path)
    saved.changed_input(study)


READERS = {
    "csv": log.read,
    "nc": log.read,
    "study": _study,
    "chunk": lambda path: chunk_files.parse(path.read_bytes()),
    "gains": lambda path: fleet.gain_set(str(path)),
    # Not the robot that is remembered of another file in its place.
    "robot": lambda path: scene.read_robot.__wrapped__(scene.Conditions(model=str(path))),
    "toml": configuration.load_file,
}


def tried(kind: str, path: Path) -> dict[str, str]:
    """Returns `refused` with the message, `raised` with a traceback, or nothing."""
    try:
        READERS[kind](path)
    except (DynabotError, chunk_files.DamagedError) as error:
        return {"refused": str(error)}
    except BaseException:
        return {"raised": traceback.format_exc()}
    return {}


def main() -> None:
    """Answers until there is nothing more to read."""
    # Libraries print where they like; the answers have a place of their own.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    faulthandler.enable()
    with contextlib.suppress(ValueError, OSError):  # not every system has it
        resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
    for line in sys.stdin:
        kind, _, path = line.rstrip("\n").partition(" ")
        print(json.dumps(tried(kind, Path(path))), file=answers, flush=True)


if __name__ == "__main__":
    main()
