"""`dynabot report`."""

import argparse
import json
import time
from pathlib import Path
from typing import Any

from dynabot_mj.commands import parsers, results
from dynabot_mj.common.exceptions import InputError


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    command = parsers.command(commands, report, parsers.shared())
    command.add_argument("folder", type=Path, metavar="DIR", help="results of a study, e.g. of dynabot compare")
    command.add_argument(
        "--out",
        type=Path,
        metavar="FILE.html",
        help="the page (default DIR/report.html); its tables go beside it, into the folder tables, those of a page "
        "FILE.html into FILE_tables",
    )


def report(options: argparse.Namespace) -> None:
    """A study as one page of HTML that needs no network, with its tables as CSV."""
    from dynabot_mj import study as studies
    from dynabot_mj.host import files, progress, result_folder
    from dynabot_mj.study import saved

    study, path = saved.load(options.folder)
    if missing := studies.missing(study):
        raise InputError(f"the study {path} has no {missing[0]}, which a report needs; run it again")
    if "grid" in study.attrs:
        count = len(set(study.point.values.tolist()))
        raise InputError(f"the study {path} is a grid of {count} configurations, a report is of one; see its table.md")
    page: Path = options.out or path.parent / "report.html"
    if page.suffix.lower() != ".html" or page.is_dir():
        raise InputError(f"--out {page} given, it must be a file whose name ends with .html")
    execution = _execution(path.with_name("execution.json"))
    changed = _changed(study)
    folder = page.parent
    tables = "tables" if options.out is None else f"{page.stem}_tables"
    files.require_writable(folder)
    with result_folder.locked(folder):
        result_folder.require_ours(folder, f"{tables}/*.csv")
        if (folder / tables).exists():
            files.require_writable(folder / tables)

        from dynabot_mj.report import contents, material

        start = time.monotonic()
        with progress.shown("report") as tell:
            gathered = material.gather(study, execution, changed, tell)
            made = contents.build(gathered)
        content = made.html.encode()
        with files.uninterrupted():
            files.require_writable(folder / tables)
            for name, text in made.tables.items():
                files.write(folder / tables / name, text.encode())
            files.write(page, content)
            result_folder.attach(folder, [page.name, *(f"{tables}/{name}" for name in made.tables)])
    document = {
        "page": str(page),
        "bytes": len(content),
        "tables": [str(folder / tables / name) for name in made.tables],
        "film": gathered.clip is not None,
        "wall_s": round(time.monotonic() - start, 3),
    }
    film = "" if gathered.clip else f"; {gathered.clip_note[0].lower()}{gathered.clip_note[1:]}"
    text = f"{page}: {len(content) / 1e6:.1f} MB in {document['wall_s']:.0f} s; tables in {folder / tables}{film}"
    results.show(options, document, text)


def _execution(path: Path) -> dict[str, Any]:
    """Returns how a study was executed; empty where nothing says it.

    Raises:
        InputError: If what says it cannot be read.
    """
    if not path.is_file():
        return {}
    try:
        found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"cannot read {path}: {error}") from error
    return found


def _changed(study: Any) -> str:
    """Returns what keeps the study's trials from being repeated; "" where nothing does."""
    from dynabot_mj.study import saved

    try:
        name = saved.changed_input(study)
    except InputError as error:
        return f"the study read a file that cannot be read any more ({error})"
    return f"the file of its {name} has changed since the study" if name else ""
