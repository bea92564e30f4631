"""What a command leaves behind: a folder that is replaced as a whole, and what it prints."""

import argparse
import contextlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from dynabot_mj import files


def open_folder(options: argparse.Namespace, name: str) -> Path:
    """Returns the folder of the results, `out/name` unless another one is given, and makes sure of it before any work.

    Raises:
        InputError: If it cannot be written to.
    """
    folder: Path = options.out or Path("out") / name
    files.require_writable(folder)
    return folder


@contextlib.contextmanager
def report(
    options: argparse.Namespace, folder: Path, name: str, document: Any, text: str, note: str = ""
) -> Iterator[Path]:
    """Writes `name.json` and `name.md`, yields their folder for figures, keeps all of it at once, and then prints.

    Args:
        options: The command's, with `--json`.
        folder: Of `open_folder`.
        name: Of the two files.
        document: What is written and, with `--json`, printed.
        text: The same as Markdown.
        note: What is printed behind the folder.
    """
    with files.staged(folder) as stage:
        (stage / f"{name}.json").write_text(dump(document), encoding="utf-8")
        (stage / f"{name}.md").write_text(text, encoding="utf-8")
        yield stage
    show(options, document, f"{text}\nresults in {folder}{note}")


def show(options: argparse.Namespace, document: Any, text: str) -> None:
    """Prints the document with `--json`, else the text."""
    print(dump(document) if options.json else text)


def dump(document: Any) -> str:
    """Returns a JSON document; undefined values have to be None in it, never NaN."""
    return json.dumps(document, indent=2, allow_nan=False)
