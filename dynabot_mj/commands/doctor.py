"""`dynabot doctor`."""

import argparse

from dynabot_mj.commands import parsers, results
from dynabot_mj.common.exceptions import DynabotError


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    parsers.command(commands, doctor, parsers.shared())


def doctor(options: argparse.Namespace) -> None:
    """What works on this machine: OpenGL, video encoder, versions; and how to mend what does not."""
    from dynabot_mj.host import doctor as examination

    checks = examination.examine(parsers.cores(), options.figures_asked)
    results.show(options, examination.document(checks), examination.text(checks))
    failures = examination.failures(checks)
    if failures:
        raise DynabotError("; ".join(f"{check.name}: {check.found}; to mend it: {check.mend}" for check in failures))
