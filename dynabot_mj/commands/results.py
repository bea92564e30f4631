"""What a command leaves behind: a folder that is replaced as a whole, and what it prints."""

import argparse
import contextlib
import json
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.host import result_folder
from dynabot_mj.host.result_folder import ResultFolder


@contextlib.contextmanager
def opened(
    options: argparse.Namespace,
    name: str,
    depends_on: Mapping[str, Any],
    names: Sequence[str],
    kept: Callable[[Path], str] = lambda folder: "",
) -> Iterator[ResultFolder]:
    """Makes sure of the folder of the results before any work, and has it to itself until they are there.

    It is the one that `--out` gives, whose other results are kept unless `--overwrite` is given, or `out/name`, which
    is scratch: what it holds is replaced, and that is said.

    Args:
        options: The command's, of `parsers.add_out`.
        name: Of the command, and of its folder.
        depends_on: What the results depend on, as plain values.
        names: Patterns of the files that will be written.
        kept: Says which parts of these results a folder keeps for `--resume` to continue; "" for none.

    Raises:
        InputError: If the folder cannot be had, see `result_folder.opened`, or there is nothing to resume.
    """
    if options.overwrite and options.out is None:
        raise InputError(f"--overwrite given without --out: out/{name} is replaced without it")
    path: Path = options.out or Path("out") / name
    contents = result_folder.Contents(command=name.replace("/", " --"), options=depends_on, files=names)
    keep = options.out is not None and not options.overwrite
    with result_folder.opened(path, contents, keep=keep) as folder:
        if folder.earlier is not None and not folder.same:
            told = f"{path} holds {result_folder.different(folder.earlier, contents)}"
            if getattr(options, "resume", False) and not options.overwrite and not kept(path):
                raise InputError(f"--resume given, but {told} and no part of this one; run without --resume")
            print(f"note: {told}; it will be replaced", file=sys.stderr)
        yield folder


@contextlib.contextmanager
def report(
    options: argparse.Namespace, folder: ResultFolder, name: str, document: Any, text: str, note: str = ""
) -> Iterator[Path]:
    """Writes `name.json` and `name.md`, yields their folder for figures, keeps all of it at once, and then prints.

    Args:
        options: The command's, with `--json`.
        folder: Of `opened`.
        name: Of the two files.
        document: What is written and, with `--json`, printed.
        text: The same as Markdown.
        note: What is printed behind the folder.
    """
    with folder.drafted() as draft:
        (draft / f"{name}.json").write_text(dump(document), encoding="utf-8")
        (draft / f"{name}.md").write_text(text, encoding="utf-8")
        yield draft
    show(options, document, f"{text}\nresults in {folder.path}{note}")


def again(options: argparse.Namespace, folder: ResultFolder, name: str) -> None:
    """Prints what `report` has written and printed before."""
    document = json.loads((folder.path / f"{name}.json").read_text(encoding="utf-8"))
    text = (folder.path / f"{name}.md").read_text(encoding="utf-8")
    show(options, document, f"{text}\nresults in {folder.path}")


def show(options: argparse.Namespace, document: Any, text: str) -> None:
    """Prints the document with `--json`, else the text."""
    print(dump(document) if options.json else text)


def dump(document: Any) -> str:
    """Returns a JSON document; undefined values have to be None in it, never NaN."""
    return json.dumps(document, indent=2, allow_nan=False)
