"""Cells of tables that no text of `common.tables` alone makes."""

import math

from dynabot_mj.common import tables
from dynabot_mj.common.intervals import Mean, Rate
from dynabot_mj.experiments.formation.summaries import ContactHazard, Settling
from dynabot_mj.testbed.paper import TRIALS_TABLE_III, TableIIIRow


def hazard(found: ContactHazard) -> str:
    """Returns a hazard with the number of trials that it leaves out."""
    return tables.interval(found, 2) + (f" ({found.excluded})" if found.excluded else "")


def off(found: Settling, paper: TableIIIRow | None) -> str:
    """Returns how far a settling time is from the paper's in standard errors of both, or nothing where unknown."""
    if found.mean is None or found.sd is None or paper is None or paper.settling_sd is None:
        return ""
    error = math.sqrt(found.sd**2 / found.n + paper.settling_sd**2 / TRIALS_TABLE_III)
    return f"{(found.mean - paper.settling) / error:+.1f}"


def settled(found: Settling, paper: TableIIIRow | None) -> str:
    """Returns how many trials settled, and with how many of them hulls overlapped."""
    return f"{found.n}" + (f" ({found.hulls})" if found.hulls else "")


def rate_beside(found: Rate | None, paper: TableIIIRow | None) -> str:
    """Returns a rate beside the paper's, or a dash."""
    return "-" if found is None else tables.rate(found)


def published(found: Mean | Rate) -> str:
    """Returns the paper's own value, with the digits that it has there."""
    if isinstance(found, Rate):
        return "-" if found.rate is None else f"{100 * found.rate:.0f}"
    return f"{found.mean:g}" + ("" if found.sd is None else f" ± {found.sd:g}")
