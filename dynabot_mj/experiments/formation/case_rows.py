"""One case of a study, summarised over its trials: a row of the tables and of the JSON document."""

from dataclasses import asdict, dataclass, replace

import numpy as np
import xarray as xr

from dynabot_mj.common import intervals
from dynabot_mj.common.arrays import Array
from dynabot_mj.common.intervals import Hazard, Mean, MeanInterval, Median, Rate
from dynabot_mj.experiments.formation import in_loop, measures
from dynabot_mj.experiments.formation.in_loop import EstimateError
from dynabot_mj.testbed.paper import TABLE_III


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


@dataclass(frozen=True, kw_only=True)
class Published:
    """The same row of the paper's Table III."""

    settling_s: float
    collision: float
    completion: float


@dataclass(frozen=True, kw_only=True)
class CaseRow:
    """One case, summarised over its trials; diverged trials count in `diverged` and nowhere else."""

    plant: str
    perception: str | None
    estimator: str
    trials: int
    period_ms: float  # T_c
    sample_period_ms: float  # T_s
    alpha_h: float
    alpha_d: float
    arrival_s: Arrival
    time_to_formation_s: Restricted
    in_band_fraction: Mean
    settling_s: Settling
    restricted_settling_s: Restricted
    top_speed_mps: Mean
    collision: Rate | None  # of centres; None for bodies
    collision_footprint: Rate
    collision_hulls_per_min: ContactHazard
    hull_contact: Rate  # undefined for point masses
    completion: Rate  # within the method's own sigma
    completion_common: Rate
    overturned: int | None  # None: an older study does not tell
    diverged: int
    velocity: str  # where the dissipation's comes from
    estimate_error: EstimateError | None  # None for perfect information
    paper: Published | None  # None: it has no such row

    @property
    def label(self) -> str:
        """Of the case, e.g. `particle/gauss-markov/gps`."""
        return "/".join(part for part in (self.plant, self.perception, self.estimator) if part)


def rows(study: xr.Dataset) -> list[CaseRow]:
    """Summarises every case of a study."""
    return [row(study.isel(case=index)) for index in range(study.sizes["case"])]


def row(case: xr.Dataset) -> CaseRow:
    """Summarises one case of a study's Dataset."""
    estimator, plant = str(case.estimator.item()), str(case.plant.item())
    settling, arrival = measures.variable(case, "settling"), measures.variable(case, "arrival")
    # An older study does not tell what did not arrive from what it does not know.
    not_arrived = np.where(measures.restricted(case, "arrival") >= 0.0, np.isnan(arrival), np.nan)
    return CaseRow(
        plant=plant,
        perception=str(case.perception.item()) or None,
        estimator=estimator,
        trials=case.sizes["trial"],
        # The periods are whole ticks; the digits beyond are floating-point noise.
        period_ms=round(1e3 * case.control_period.item(), 9),
        sample_period_ms=round(1e3 * case.sample_period.item(), 9),
        alpha_h=case.alpha_h.item(),
        alpha_d=case.alpha_d.item(),
        arrival_s=Arrival(
            **asdict(intervals.mean(arrival)),
            not_arrived=intervals.rate(not_arrived),
            restricted=_restricted(case, "arrival"),
        ),
        time_to_formation_s=_restricted(case, "formation"),
        in_band_fraction=intervals.mean(measures.variable(case, "in_band")),
        settling_s=Settling(
            **asdict(intervals.mean(settling)),
            unsettled=intervals.rate(1.0 - case.settled),
            hulls=int((np.isfinite(settling) & (case.collision_footprint.values == 1.0)).sum()),
        ),
        restricted_settling_s=_restricted(case, "settling"),
        top_speed_mps=intervals.mean(case.top_speed),
        collision=None if plant == "rigid" else intervals.rate(case.collision),
        collision_footprint=intervals.rate(case.collision_footprint),
        collision_hulls_per_min=_hazard(case),
        hull_contact=intervals.rate(case.hull_contact),
        completion=intervals.rate(case.completion),
        completion_common=intervals.rate(case.completion_common),
        overturned=int(case.overturned.notnull().sum()) if "overturned" in case.variables else None,
        diverged=int(case.diverged.sum()),
        velocity=str(case.velocity.item()),
        estimate_error=in_loop.errors(case),
        paper=_published(estimator),
    )


def _published(estimator: str) -> Published | None:
    if (row := TABLE_III.get(estimator)) is None:
        return None
    return Published(settling_s=row.settling, collision=row.collision, completion=row.completion)


def _restricted(case: xr.Dataset, name: str) -> Restricted:
    times, horizon = measures.restricted(case, name), float(case.attrs["duration"])
    known: Array = times[np.isfinite(times)]
    without = known >= horizon
    middle = intervals.median_between(known, np.where(without, np.inf, known))
    return Restricted(
        **asdict(intervals.bootstrapped(known, int(case.attrs["seed"]))),
        horizon_s=horizon,
        median=middle if middle.low is None or middle.low < horizon else replace(middle, low=None),
        without=intervals.rate(without),
    )


def _hazard(case: xr.Dataset) -> ContactHazard:
    arrival, contact = measures.variable(case, "arrival"), measures.variable(case, "contact")
    early = np.isfinite(contact) & ~(contact > arrival)
    at_risk = np.isfinite(arrival) & ~early
    until = np.fmin(contact, float(case.attrs["duration"]))
    found = intervals.hazard(
        int((at_risk & np.isfinite(contact)).sum()), float((until - arrival)[at_risk].sum()) / 60.0
    )
    told = {"arrival", "contact"} <= set(case.variables)
    return ContactHazard(**asdict(found), excluded=int(early.sum()) if told else None)
