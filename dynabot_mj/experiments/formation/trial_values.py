"""What a study's Dataset says of each trial of a case."""

from collections.abc import Callable

import numpy as np
import xarray as xr

from dynabot_mj.common.arrays import Array
from dynabot_mj.formation import metrics
from dynabot_mj.plants.kinds import KINDS


def variable(case: xr.Dataset, name: str) -> Array:
    """Returns a variable of one case, (trials,); NaN where an older study does not have it."""
    if name not in case.variables:
        return np.full(case.sizes["trial"], np.nan)
    found: Array = case[name].values
    return found


def read(name: str) -> Callable[[xr.Dataset], Array]:
    """Returns what reads a variable of a case, see `variable`."""
    return lambda case: variable(case, name)


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


def of_centres(case: xr.Dataset) -> Array:
    """Returns the paper's collision, (trials,); undefined for bodies, whose centres cannot come that near."""
    found = variable(case, "collision")
    return np.full_like(found, np.nan) if KINDS[str(case.plant.item())].body else found
