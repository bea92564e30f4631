"""`dynabot schedule`."""

import argparse

from dynabot_mj.commands import parsers, results, studies


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    command = parsers.command(commands, schedule, parsers.shared())
    command.add_argument("--robots", type=int, default=3, help="number of robots, 2 to 7 (default 3)")
    command.add_argument("--utilisation", type=float, default=1.0, help="bound U of Eq. 1 (default 1.0)")


def schedule(options: argparse.Namespace) -> None:
    """Shortest periods that the processor can keep, Eqs. 1-3."""
    from dynabot_mj.perception.methods import METHODS
    from dynabot_mj.testbed import schedule as eqs

    times = {name: record.estimation_time for name, record in METHODS.items() if record.filter}
    rows = eqs.table(options.robots, options.utilisation, times)
    for row in rows:
        studies.note_load(row.estimator, row.load, options.utilisation)
    keys = ("estimator", "t_se_ms", "period_exact_ms", "period_ms")
    document = {
        "robots": options.robots,
        "utilisation": options.utilisation,
        "rows": [{key: getattr(row, key) for key in keys} for row in rows],
    }
    text = [f"{options.robots} robots, utilisation bound {options.utilisation:g}"]
    text += ["estimator  t_se [ms]  T exact [ms]  T [ms]"]
    text += [f"{r.estimator:<9}  {r.t_se_ms:9.1f}  {r.period_exact_ms:12.2f}  {r.period_ms:6g}" for r in rows]
    results.show(options, document, "\n".join(text))
