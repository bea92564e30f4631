"""`dynabot study`."""

import argparse
from pathlib import Path
from typing import Any

from dynabot_mj.commands import parsers, results, setups, studies

_FILES = ("table.md", "campaign.json", "campaign.png")


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    from dynabot_mj.experiments.formation.grid import SHOWN

    command = parsers.command(commands, study, parsers.study(), parsers.execution())
    command.add_argument(
        "file", type=Path, metavar="FILE.toml", help="configuration and its [grid], see docs/campaigns.md"
    )
    command.add_argument("--trials", type=int, help="trials of each case (default 100)")
    command.add_argument("--over", nargs="+", metavar="FACTOR", help="one or two factors to show measures over")
    command.add_argument("--measures", nargs="+", metavar="NAME", help=f"to show (default {' '.join(SHOWN)})")
    command.add_argument(
        "--pair",
        nargs=2,
        action="append",
        metavar="CASE",
        dest="pairs",
        help="two cases to compare; again for more",
    )


def study(options: argparse.Namespace) -> None:
    """Any grid of configurations: every case of it, measures over its factors, differences on the same trials."""
    from dynabot_mj.experiments.formation import grid, grid_tables
    from dynabot_mj.figures import grid as figure
    from dynabot_mj.figures import style

    made = _campaign(options)
    with studies.opened(options, "study", made, _FILES) as folder:
        dataset, wall_s = studies.obtain(made, folder, options, "study")
        pairs = [(a, b) for a, b in options.pairs or ()]
        found = grid.found(dataset, made, options.over, options.measures or grid.SHOWN, pairs)
        document, text = grid.document(found), grid_tables.markdown(found)
        with studies.drafted(folder, made, dataset, options, wall_s) as draft:
            (draft / "table.md").write_text(text, encoding="utf-8")
            (draft / "campaign.json").write_text(results.dump(document), encoding="utf-8")
            style.save(figure.grid(found), draft / "campaign.png")
    studies.show(options, folder, document, text, wall_s)


def _campaign(options: argparse.Namespace) -> Any:
    """Reads the campaign, and refuses what cannot be shown of it before any work."""
    from dynabot_mj.common.exceptions import InputError
    from dynabot_mj.experiments.formation import grid
    from dynabot_mj.study import campaign

    if options.config:
        raise InputError(f"--config {options.config} given; study takes its file by itself: dynabot study FILE.toml")
    given, typed = setups.overriding(options)
    made = campaign.load_file(options.file, typed=typed, **given)
    for point in made.points[:1]:
        setups.look_for_idle(options, point.setup, typed)
    grid.check(made, options.over, options.measures or grid.SHOWN, [tuple(pair) for pair in options.pairs or ()])
    return made
