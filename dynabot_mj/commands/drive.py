"""`dynabot drive`."""

import argparse
from dataclasses import asdict

from dynabot_mj.commands import parsers, results


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    command = parsers.command(commands, drive, parsers.vehicle())
    command.add_argument("--step-sizes", action="store_true", help="repeat it for physics steps from 0.5 to 8 ms too")


def drive(options: argparse.Namespace) -> None:
    """Acceptance drive of the rigid robot, its motors commanded directly."""
    from dynabot_mj.experiments.vehicle import drive as experiment
    from dynabot_mj.experiments.vehicle import drive_report
    from dynabot_mj.figures import vehicle
    from dynabot_mj.figures.style import save

    conditions = parsers.conditions(options)
    depends_on = {**asdict(conditions), "step_sizes": options.step_sizes}
    with results.opened(options, "drive", depends_on, ("drive.json", "drive.md", "drive.png")) as folder:
        report = experiment.drive(conditions)
        document, text = drive_report.document(report), drive_report.markdown(report)
        if options.step_sizes:
            found = drive_report.step_sizes(conditions)
            document["step_sizes"] = drive_report.step_document(found)
            text += f"\n{drive_report.step_table(found)}"
        with results.report(options, folder, "drive", document, text) as draft:
            save(vehicle.acceptance_drive(report), draft / "drive.png")
