"""What is asked of a pilot study, and whether it can be answered."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from dynabot_mj.common import intervals
from dynabot_mj.common.arrays import Array
from dynabot_mj.common.exceptions import InputError, suggestion
from dynabot_mj.experiments.formation import power_laws
from dynabot_mj.experiments.formation.measure import FACTORS, PairedMeasure
from dynabot_mj.experiments.formation.measures import PAIRED

FEWEST = 10  # pairs of a pilot
HIGHEST = 0.99  # power, beyond which simulation tells nothing
ROUNDING = 1e-9


@dataclass(frozen=True, kw_only=True)
class Request:
    """What is asked."""

    a: str
    b: str
    measure: str
    difference: float | None = None  # a - b, in the measure's unit; None: the pilot's own
    power: float = 0.8
    alpha: float = 0.05
    comparisons: int = 1  # of the family: Holm's first step holds the smallest p to alpha / comparisons


def judge(study: xr.Dataset, request: Request) -> PairedMeasure[Any]:
    """Returns the measure of a request that can be answered.

    Raises:
        InputError: If there is no answer to it in this study.
    """
    by_name = {one.name: one for one in PAIRED}
    if (measure := by_name.get(request.measure)) is None:
        hint = suggestion(request.measure, by_name)
        raise InputError(f"--measure {request.measure} given, it must be one of {', '.join(by_name)}{hint}")
    labels = [str(one) for one in study.case.values]
    for name in (request.a, request.b):
        if name not in labels:
            raise InputError(f"--cases {name} given, the pilot has: {', '.join(labels)}{suggestion(name, labels)}")
    if request.a == request.b:
        raise InputError(f"--cases {request.a} given twice, it must be two cases")
    one, other = (study.sel(case=name) for name in (request.a, request.b))
    for factor in FACTORS:
        if one[factor] != other[factor] and factor not in measure.factors:
            raise InputError(f"--measure {measure.name} given, which is not compared between cases of another {factor}")
    if not 0.0 < request.alpha < 1.0:
        raise InputError(f"--alpha {request.alpha:g} given, allowed is 0 < alpha < 1")
    if request.comparisons < 1:
        raise InputError(f"--comparisons {request.comparisons} given, it must be at least 1")
    if not request.alpha < request.power <= HIGHEST:
        meant = f"; a fraction is meant: {request.power / 100.0:g}?" if 1.0 < request.power < 100.0 else ""
        allowed = f"it must be above alpha, {request.alpha:g}, and at most {HIGHEST:g}"
        raise InputError(f"--power {request.power:g} given, {allowed}{meant}")
    if not measure.rate and request.alpha / request.comparisons <= power_laws.SMALLEST_P:
        raise InputError(
            f"--alpha {request.alpha:g} over {request.comparisons} comparisons given, which must be above "
            f"{power_laws.SMALLEST_P:g}: the permutation test tells no smaller p"
        )
    _judge_difference(study, measure, request.difference)
    differences(measure, request, measure.values(one), measure.values(other))
    return measure


def _judge_difference(study: xr.Dataset, measure: PairedMeasure[Any], difference: float | None) -> None:
    if difference is None:
        return
    told = f"--difference {difference:g} given"
    if not math.isfinite(difference) or difference == 0.0:
        raise InputError(f"{told}, it must be a number of {measure.unit} other than 0")
    most = {"s": float(study.attrs["duration"]), "points": 100.0}.get(measure.unit, math.inf)
    if abs(difference) > most:
        why = "the duration of the pilot's trials" if measure.unit == "s" else "from none to all"
        raise InputError(f"{told}, allowed are {-most:g} to {most:g} {measure.unit}, {why}")


def differences(measure: PairedMeasure[Any], request: Request, a: Array, b: Array) -> Array:
    """Returns the pilot's paired differences.

    Raises:
        InputError: If they say too little.
    """
    for name, values in ((request.a, a), (request.b, b)):
        if not np.isfinite(values).any():
            raise InputError(f"--measure {measure.name} given, which no trial of {name} has in the pilot")
    found: Array = (a - b)[np.isfinite(a - b)]
    if len(found) < FEWEST:
        raise InputError(
            f"the pilot has {len(found)} trials with {measure.name} in both cases, it must be at least {FEWEST}"
        )
    if request.difference is None and abs(found.mean()) < ROUNDING:
        raise InputError("the pilot's own difference is 0, for which no number of trials is enough; give --difference")
    if not measure.rate and intervals.constant(found):
        raise InputError(
            f"{measure.name} differs by the same in all trials of the pilot, whose spread tells no number of trials"
        )
    return found
