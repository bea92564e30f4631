"""Summaries of the trials of a case, and how they are taken; those of `common.intervals`, and what is ours alone."""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace

import numpy as np
import xarray as xr

from dynabot_mj.common import intervals
from dynabot_mj.common.arrays import Array
from dynabot_mj.common.intervals import Hazard, Mean, MeanInterval, Median, Rate
from dynabot_mj.experiments.formation import trial_values
from dynabot_mj.plants.kinds import KINDS
from dynabot_mj.testbed.paper import TRIALS_TABLE_III, TableIIIRow


@dataclass(frozen=True, kw_only=True)
class Restricted(MeanInterval):
    """Mean of a first-passage time up to a horizon, which counts for trials without the event or with a contact first.

    The median and the bounds of its interval are over all trials; None where they are beyond the horizon. `without` has
    not had the event, or only after a contact.
    """

    horizon_s: float
    median: Median
    without: Rate


@dataclass(frozen=True, kw_only=True)
class Arrival(Mean):
    """Arrival over the trials that arrived, whatever happened before."""

    not_arrived: Rate
    restricted: Restricted


@dataclass(frozen=True, kw_only=True)
class Settling(Mean):
    """The paper's settling time over the trials that settled and whose centres did not collide.

    It depends on the length of the run.
    """

    unsettled: Rate  # among the trials whose centres did not collide
    hulls: int  # of the n trials, those in which footprints overlapped


@dataclass(frozen=True, kw_only=True)
class ContactHazard(Hazard):
    """First contacts of footprints after arrival, per minute at risk: from arrival to contact or end."""

    excluded: int | None  # trials with a contact at or before arrival; None: an older study does not tell


def span(found: Mean | MeanInterval | Hazard | Rate | None) -> tuple[float | None, float | None, float | None]:
    """Returns the value of a summary and where it is from and to: mean less and plus sd where it has no interval."""
    if found is None:
        return None, None, None
    if not isinstance(found, Mean):
        return (found.mean if isinstance(found, MeanInterval) else found.rate), found.low, found.high
    if found.mean is None or found.sd is None:
        return found.mean, None, None
    return found.mean, found.mean - found.sd, found.mean + found.sd


def mean(name: str) -> Callable[[xr.Dataset], Mean]:
    """Returns what takes the mean of a variable of a case."""
    return lambda case: intervals.mean(trial_values.variable(case, name))


def rate(name: str) -> Callable[[xr.Dataset], Rate]:
    """Returns what takes the share of ones of a variable of a case."""
    return lambda case: intervals.rate(trial_values.variable(case, name))


def restricted(name: str) -> Callable[[xr.Dataset], Restricted]:
    """Returns what takes the restricted mean of an event of a case, see `trial_values.restricted`."""

    def taken(case: xr.Dataset) -> Restricted:
        times, horizon = trial_values.restricted(case, name), float(case.attrs["duration"])
        known: Array = times[np.isfinite(times)]
        without = known >= horizon
        middle = intervals.median_between(known, np.where(without, np.inf, known))
        return Restricted(
            **asdict(intervals.bootstrapped(known, int(case.attrs["seed"]))),
            horizon_s=horizon,
            median=middle if middle.low is None or middle.low < horizon else replace(middle, low=None),
            without=intervals.rate(without),
        )

    return taken


def arrival(case: xr.Dataset) -> Arrival:
    """Returns the arrival of a case's robots."""
    times = trial_values.variable(case, "arrival")
    # An older study does not tell what did not arrive from what it does not know.
    not_arrived = np.where(trial_values.restricted(case, "arrival") >= 0.0, np.isnan(times), np.nan)
    return Arrival(
        **asdict(intervals.mean(times)),
        not_arrived=intervals.rate(not_arrived),
        restricted=restricted("arrival")(case),
    )


def settling(case: xr.Dataset) -> Settling:
    """Returns the paper's settling of a case."""
    times = trial_values.variable(case, "settling")
    return Settling(
        **asdict(intervals.mean(times)),
        unsettled=intervals.rate(1.0 - case.settled),
        hulls=int((np.isfinite(times) & (case.collision_footprint.values == 1.0)).sum()),
    )


def collision_of_centres(case: xr.Dataset) -> Rate | None:
    """Returns the paper's collision of a case; None for bodies."""
    return None if KINDS[str(case.plant.item())].body else rate("collision")(case)


def contact_hazard(case: xr.Dataset) -> ContactHazard:
    """Returns how often hulls touch once the robots of a case have arrived."""
    arrived, contact = (trial_values.variable(case, name) for name in ("arrival", "contact"))
    early = np.isfinite(contact) & ~(contact > arrived)
    at_risk = np.isfinite(arrived) & ~early
    until = np.fmin(contact, float(case.attrs["duration"]))
    found = intervals.hazard(
        int((at_risk & np.isfinite(contact)).sum()), float((until - arrived)[at_risk].sum()) / 60.0
    )
    told = {"arrival", "contact"} <= set(case.variables)
    return ContactHazard(**asdict(found), excluded=int(early.sum()) if told else None)


def published_settling(row: TableIIIRow) -> Mean:
    """Returns the settling time of a row of Table III."""
    return Mean(mean=row.settling, sd=row.settling_sd, n=TRIALS_TABLE_III)


def published_rate(share: float) -> Rate:
    """Returns a rate of Table III with the interval that its number of trials gives."""
    return intervals.share(round(share * TRIALS_TABLE_III), TRIALS_TABLE_III)
