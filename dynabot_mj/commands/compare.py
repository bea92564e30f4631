"""`dynabot compare`."""

import argparse
import shutil
from pathlib import Path
from typing import Any

from dynabot_mj.commands import parsers, results, setups, studies

_FILES = (
    "table.md",
    "compare.json",
    "fitted.toml",
    "errors.png",
    "table_iii.png",
    "outcomes.png",
    "incidence.png",
    "trajectories_*.png",
)
_READINGS = ".readings"  # folder of the finished parts of a sensitivity study, until it is complete


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    from dynabot_mj.plants.kinds import PLANTS
    from dynabot_mj.study.scenario import PERCEPTIONS

    command = parsers.command(commands, compare, parsers.study(), parsers.execution())
    command.add_argument("--trials", type=int, help="trials of each case (default 100)")
    command.add_argument("--plants", nargs="+", choices=PLANTS)
    command.add_argument("--estimators", nargs="+", metavar="NAME", help=parsers.methods_help())
    command.add_argument(
        "--perception",
        nargs="+",
        choices=PERCEPTIONS,
        help="gauss-markov: the paper's error; filter: real estimators on simulated sensors; fitted: an error with the "
        "filters' statistics (default gauss-markov)",
    )
    command.add_argument(
        "--sensitivity",
        action="store_true",
        help="instead: the readings of the paper that are ours, one changed at a time, on point masses",
    )


def compare(options: argparse.Namespace) -> None:
    """Every estimator on both plants, the paper's Table III beside them."""
    if options.sensitivity:
        _sensitivity(options)
        return
    from dynabot_mj.experiments.formation import compare as experiment
    from dynabot_mj.experiments.formation import compare_tables, in_loop
    from dynabot_mj.study import campaign

    made = campaign.single(_setup(options))
    with studies.opened(options, "compare", made, _FILES) as folder:
        if studies.again(options, folder, "compare.json", "table.md"):
            return
        study, wall_s = studies.obtain(made, folder, options, "compare")
        comparison = experiment.compared(study)
        table, document = compare_tables.markdown(comparison), experiment.document(comparison)
        studies.note_late(comparison)
        with studies.drafted(folder, made, study, options, wall_s) as draft:
            (draft / "table.md").write_text(table, encoding="utf-8")
            (draft / "compare.json").write_text(results.dump(document), encoding="utf-8")
            if (fitted := in_loop.fitted_toml(study)) is not None:
                (draft / "fitted.toml").write_text(fitted, encoding="utf-8")
            _draw(comparison, draft)
    studies.show(options, folder, document, table, wall_s)


def _draw(comparison: Any, draft: Path) -> None:
    """Draws the figures of a comparison."""
    from dynabot_mj.figures import autocorrelations, bars, distributions, paths, style

    study = comparison.study
    if (errors := autocorrelations.errors(study)) is not None:
        style.save(errors, draft / "errors.png")
    style.save(bars.table_iii(comparison), draft / "table_iii.png")
    style.save(bars.outcomes(comparison), draft / "outcomes.png")
    if (incidence := distributions.incidence(study)) is not None:
        style.save(incidence, draft / "incidence.png")
    shown = list(dict.fromkeys(zip(study.estimator.values, study.perception.values, strict=True)))
    for estimator, perception in shown:
        several = sum(name == estimator for name, _ in shown) > 1
        name = f"trajectories_{estimator}_{perception}" if several else f"trajectories_{estimator}"
        style.save(paths.trajectories(study, estimator, perception), draft / f"{name}.png")


def _setup(options: argparse.Namespace) -> Any:
    return setups.build(options, plants=options.plants, estimators=options.estimators, perception=options.perception)


def _sensitivity(options: argparse.Namespace) -> None:
    """Runs the study once for each reading."""
    from dynabot_mj.experiments.formation import sensitivity
    from dynabot_mj.figures import sensitivity as sensitivity_figure
    from dynabot_mj.figures import style
    from dynabot_mj.study import campaign, configuration, trial_chunks

    setup = sensitivity.prepared(_setup(options))

    def place(folder: Path, name: str) -> Path:
        return folder / _READINGS / name.replace(" ", "-")

    def kept(folder: Path) -> str:
        return studies.told_kept(
            [
                (trial_chunks.chunks(campaign.single(one.changed(setup))), place(folder, one.name))
                for one in sensitivity.readings(setup)
            ]
        )

    names = tuple(f"sensitivity.{suffix}" for suffix in ("json", "md", "png"))
    with studies.opened(options, "sensitivity", campaign.single(setup), names, kept) as folder:
        if options.resume and folder.whole:
            results.again(options, folder, "sensitivity")
            return

        def run(name: str, changed: Any) -> Any:
            parts = place(folder.path, name)
            parts.mkdir(parents=True, exist_ok=True)
            return studies.run(campaign.single(changed), parts, options, name, notes=changed is setup)[0]

        found = sensitivity.examine(setup, run)
        document, text = sensitivity.document(found), sensitivity.markdown(found)
        with results.report(options, folder, "sensitivity", document, text) as draft:
            (draft / "study.toml").write_text(configuration.dump(setup), encoding="utf-8")
            style.save(sensitivity_figure.sensitivity(found), draft / "sensitivity.png")
        shutil.rmtree(folder.path / _READINGS)
