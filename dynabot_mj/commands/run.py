"""`dynabot run`."""

import argparse
from dataclasses import asdict

from dynabot_mj.commands import parsers, results, studies, trials


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    parsers.command(commands, run, parsers.study(), trials.parser())


def run(options: argparse.Namespace) -> None:
    """One trial of one case."""
    import numpy as np

    from dynabot_mj import figures
    from dynabot_mj.experiments import case_rows, single_trial

    setup = trials.chosen(options)
    folder = results.open_folder(options, "run")
    study, wall_s = studies.run(setup, folder, options, "run")
    case = study.isel(case=0)
    row = asdict(case_rows.row(case))
    places = case.final_position_w.isel(trial=0).values
    row["final_position_m"] = [[float(x) if np.isfinite(x) else None for x in place] for place in places]
    with studies.staged(folder, setup, study, options, wall_s) as stage:
        figures.save(
            figures.trajectories(study, setup.estimators[0], str(case.perception.item())), stage / "trajectories.png"
        )
    shown = ", ".join(f"({x:.2f}, {y:.2f})" for x, y in places)
    text = single_trial.markdown(case) + f"\nfinal positions [m]: {shown}\n{wall_s:.1f} s; results in {folder}"
    results.show(options, row, text)
