"""`dynabot run`."""

import argparse

from dynabot_mj.commands import parsers, results, studies, trials

_FILES = ("run.json", "run.md", "trajectories.png")


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    command = parsers.command(commands, run, parsers.study(), trials.parser())
    command.set_defaults(workers=1, threads=1, scheduler=None, resume=False)  # it has a single part


def run(options: argparse.Namespace) -> None:
    """One trial of one case."""
    import numpy as np

    from dynabot_mj.experiments.formation import case_rows, single_trial
    from dynabot_mj.figures import paths, style
    from dynabot_mj.study import campaign

    setup = trials.chosen(options)
    made = campaign.single(setup)
    with studies.opened(options, "run", made, _FILES, kept=lambda folder: "") as folder:
        study, wall_s = studies.run(made, None, options, "run")
        case = study.isel(case=0)
        # A study keeps the path of its first trial alone.
        judged = {name: case[name].isel(trial=0).values for name in case.data_vars if "trial" in case[name].dims}
        trials.tell_identical(options, judged)
        row = case_rows.document(case_rows.row(case))
        places = case.final_position_w.isel(trial=0).values
        row["final_position_m"] = [[float(x) if np.isfinite(x) else None for x in place] for place in places]
        shown = ", ".join(f"({x:.2f}, {y:.2f})" for x, y in places)
        text = single_trial.markdown(case) + f"\nfinal positions [m]: {shown}"
        figure = paths.trajectories(study, setup.estimators[0], str(case.perception.item()))
        with studies.drafted(folder, made, study, options, wall_s) as draft:
            (draft / "run.json").write_text(results.dump(row), encoding="utf-8")
            (draft / "run.md").write_text(text, encoding="utf-8")
            style.save(figure, draft / "trajectories.png")
    results.show(options, row, f"{text}\n{wall_s:.1f} s; results in {folder.path}")
