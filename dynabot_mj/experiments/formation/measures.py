"""The measures that cases are compared by, trial by trial; `dynabot_mj.formation.metrics` defines them.

Each says what it may be concluded from: what two cases may differ in, so that a difference of the measure is one of
the robots and not of the measure.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
import xarray as xr

from dynabot_mj.common.arrays import Array
from dynabot_mj.formation import metrics

Factor = Literal["estimator", "plant", "perception"]
FACTORS: tuple[Factor, ...] = get_args(Factor)


@dataclass(frozen=True, kw_only=True)
class Measure:
    """One number per trial."""

    name: str  # in JSON
    title: str  # of a column or a panel, with its unit
    values: Callable[[xr.Dataset], Array]  # of one case, (trials,); NaN where undefined
    rate: bool = False  # zeros and ones
    scale: float = 1.0  # of what is shown
    digits: int = 2
    factors: tuple[Factor, ...] = FACTORS  # that it is compared over
    tested: bool = True  # False: shown for continuity, nothing is concluded from it
    censored: bool = False  # at the duration, beyond which it may be anything


def variable(case: xr.Dataset, name: str) -> Array:
    """Returns a variable of one case, (trials,); NaN where an older study does not have it."""
    if name not in case.variables:
        return np.full(case.sizes["trial"], np.nan)
    found: Array = case[name].values
    return found


def failure(case: xr.Dataset) -> Array:
    """Returns when a contact or an overturned body first decided a trial, (trials,) [s]; NaN: never."""
    return np.fmin(variable(case, "contact"), variable(case, "overturned"))


def restricted(case: xr.Dataset, name: str) -> Array:
    """Returns the times of an event up to the duration, see `metrics.restricted`, (trials,) [s].

    NaN for trials that diverged, and all where an older study does not tell the event or the failures, or where the run
    was too short to settle.
    """
    duration = float(case.attrs["duration"])
    told = {name, "contact", "overturned"} <= set(case.variables)
    if not told or (name == "settling" and duration < metrics.SHORTEST_JUDGED):
        return np.full(case.sizes["trial"], np.nan)
    times = metrics.restricted(variable(case, name), failure(case), duration)
    return np.where(case.diverged.values == 1, np.nan, times)


def _read(name: str) -> Callable[[xr.Dataset], Array]:
    return lambda case: variable(case, name)


def _of_centres(case: xr.Dataset) -> Array:
    """Returns the paper's collision; undefined for bodies, whose centres cannot come that near."""
    found = variable(case, "collision")
    return np.full_like(found, np.nan) if str(case.plant.item()) == "rigid" else found


_WITHIN_A_PLANT: tuple[Factor, ...] = ("estimator", "perception")

MEASURES = (
    Measure(name="arrival_s", title="arrival [s]", values=_read("arrival")),
    Measure(
        name="time_to_formation_s",
        title="formation [s]",
        values=lambda case: restricted(case, "formation"),
        digits=1,
        censored=True,
    ),
    Measure(name="in_band_fraction", title="in band", values=_read("in_band"), scale=100.0, digits=0),
    Measure(
        name="collision_footprint", title="hulls", values=_read("collision_footprint"), rate=True, scale=100.0, digits=0
    ),
    Measure(
        name="completion_common", title="band 1 m", values=_read("completion_common"), rate=True, scale=100.0, digits=0
    ),
    Measure(
        name="completion",
        title="completion, own σ",
        values=_read("completion"),
        rate=True,
        scale=100.0,
        digits=0,
        factors=_WITHIN_A_PLANT,
        tested=False,  # each estimator is judged by another tolerance
    ),
    Measure(
        name="collision",
        title="collision of centres",
        values=_of_centres,
        rate=True,
        scale=100.0,
        digits=0,
        factors=_WITHIN_A_PLANT,
        tested=False,
    ),
    Measure(name="top_speed_mps", title="top speed [m/s]", values=_read("top_speed"), tested=False),
    Measure(name="settling_s", title="settling [s]", values=_read("settling"), tested=False),
    Measure(
        name="restricted_settling_s",
        title="settling, restricted [s]",
        values=lambda case: restricted(case, "settling"),
        tested=False,
    ),
)
TESTED = tuple(one for one in MEASURES if one.tested)
