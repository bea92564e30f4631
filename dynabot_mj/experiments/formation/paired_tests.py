"""Which cases of a study differ on the same trials, and whether by more than chance.

Cases are paired that differ in one factor alone: estimators on one plant with one perception, plants, perceptions.
`perfect` is a reference and no estimator that a robot could choose: it is paired over plants only. Interactions are
differences of such differences: whether the body matters more with one perception than with another. The p values of
one factor (of one table) are one family for Holm's adjustment.
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from dynabot_mj.common import intervals
from dynabot_mj.common.arrays import Array
from dynabot_mj.common.intervals import Difference, Median
from dynabot_mj.experiments.formation.measure import FACTORS, Factor, PairedMeasure
from dynabot_mj.experiments.formation.measures import PAIRED, TESTED
from dynabot_mj.plants.kinds import KINDS

_UNDEFINED = Difference(difference=None, low=None, high=None, n=0, p=None)
_EQUIVALENCE_CONFIDENCE = 0.90  # of two one-sided tests at 5 %
_FEWEST_EQUIVALENT = 10  # pairs, below which nothing is told equivalent


def margins(horizon: float) -> dict[str, float]:
    """Returns within what the fitted surrogate is held to be as good as the filters, stated before it was judged.

    A second of arrival, a twentieth of the horizon [s] of the time to formation, a tenth of the trials or of the time.
    """
    return {one.name: one.margin * (horizon if one.censored else 1.0) for one in TESTED if one.margin is not None}


@dataclass(frozen=True, kw_only=True)
class Paired(Difference):
    """Mean difference a - b of a measure over the trials where both cases have a value."""

    factor: str  # what the cases differ in
    a: str
    b: str
    metric: str
    p_holm: float | None  # None where nothing is concluded from it


@dataclass(frozen=True, kw_only=True)
class Interaction(Difference):
    """Difference particle - rigid with perception a less that with perception b, on the same trials."""

    estimator: str
    a: str
    b: str
    metric: str
    p_holm: float | None


@dataclass(frozen=True, kw_only=True)
class Equivalence:
    """Whether the fitted surrogate is as good as the filters, by two one-sided tests at 5 %."""

    plant: str
    estimator: str
    metric: str
    margin: float
    difference: float | None  # filter - fitted
    low: float | None  # of the 90 % interval
    high: float | None
    n: int
    equivalent: bool | None  # None where there is too little to tell it by


def paired(study: xr.Dataset) -> list[Paired]:
    """Compares all cases that differ in one factor; an earlier case minus a later one, particle minus rigid."""
    found: list[Paired] = []
    for factor in FACTORS:
        family = [
            Paired(
                factor=factor,
                a=str(one.case.item()),
                b=str(other.case.item()),
                metric=measure.name,
                **vars(_compared(measure, factor, one, other)),
                p_holm=None,
            )
            for one, other in pairs(study, factor)
            for measure in PAIRED
        ]
        found += [replace(one, p_holm=p) for one, p in zip(family, intervals.holm([o.p for o in family]), strict=True)]
    return found


def two_cases(one: xr.Dataset, other: xr.Dataset, a: str, b: str, factor: str) -> list[Paired]:
    """Compares any two cases by the measures that may be concluded from, without adjustment for several tests.

    Args:
        one: A case.
        other: Another, of the same trials.
        a: What the first is called.
        b: What the other is called.
        factor: What they differ in.
    """
    found = []
    for measure in TESTED:
        known = factor not in FACTORS or factor in measure.factors
        if measure.censored and one.attrs["duration"] != other.attrs["duration"]:
            known = False
        difference = _difference(measure, one, other) if known else _UNDEFINED
        found.append(Paired(factor=factor, a=a, b=b, metric=measure.name, **vars(difference), p_holm=None))
    return found


def interactions(study: xr.Dataset) -> list[Interaction]:
    """Tells for each estimator whether the body's effect differs between two perceptions."""
    seed, found = int(study.attrs["seed"]), []
    for (one, other), (third, fourth) in itertools.combinations(pairs(study, "plant"), 2):
        plants = [[str(case.plant.item()) for case in pair] for pair in ((one, other), (third, fourth))]
        if one.estimator != third.estimator or one.perception == third.perception or plants[0] != plants[1]:
            continue
        for measure in TESTED:
            first, second = (measure.values(a) - measure.values(b) for a, b in ((one, other), (third, fourth)))
            difference = intervals.paired_difference(first, second, seed)
            if measure.censored:  # a difference of four times, each of which may be beyond the horizon
                difference = replace(difference, median=None)
            found.append(
                Interaction(
                    estimator=str(one.estimator.item()),
                    a=str(one.perception.item()),
                    b=str(third.perception.item()),
                    metric=measure.name,
                    **vars(difference),
                    p_holm=None,
                )
            )
    adjusted = intervals.holm([one.p for one in found])
    return [replace(one, p_holm=p) for one, p in zip(found, adjusted, strict=True)]


def equivalences(study: xr.Dataset) -> list[Equivalence]:
    """Judges the fitted surrogate against the filters, where a study has both."""
    found, allowed = [], margins(float(study.attrs["duration"]))
    for one, other in pairs(study, "perception"):
        names = [str(case.perception.item()) for case in (one, other)]
        if sorted(names) != ["filter", "fitted"]:
            continue
        if names[0] == "fitted":
            one, other = other, one
        for measure in TESTED:
            if (margin := allowed.get(measure.name)) is None:
                continue
            difference = _difference(measure, one, other, _EQUIVALENCE_CONFIDENCE)
            low, high = difference.low, difference.high
            found.append(
                Equivalence(
                    plant=str(one.plant.item()),
                    estimator=str(one.estimator.item()),
                    metric=measure.name,
                    margin=margin,
                    difference=difference.difference,
                    low=low,
                    high=high,
                    n=difference.n,
                    equivalent=None
                    if low is None or high is None or _says_nothing(measure, one, other)
                    else -margin <= low and high <= margin,
                )
            )
    return found


def pairs(study: xr.Dataset, factor: Factor) -> Iterator[tuple[xr.Dataset, xr.Dataset]]:
    """Yields the cases that differ in one factor alone."""
    cases = [study.isel(case=index) for index in range(study.sizes["case"])]
    others, order = [name for name in FACTORS if name != factor], [*KINDS]
    for one, other in itertools.combinations(cases, 2):
        if one[factor] == other[factor] or any(one[name] != other[name] for name in others):
            continue
        turned = factor == "plant" and order.index(str(one.plant.item())) > order.index(str(other.plant.item()))
        yield (other, one) if turned else (one, other)


def _compared(measure: PairedMeasure[Any], factor: Factor, one: xr.Dataset, other: xr.Dataset) -> Difference:
    """Compares two cases by a measure, as far as it may be."""
    if factor not in measure.factors:
        return _UNDEFINED
    difference = _difference(measure, one, other)
    return difference if measure.tested else replace(difference, p=None)


def _difference(
    measure: PairedMeasure[Any], one: xr.Dataset, other: xr.Dataset, confidence: float = intervals.CONFIDENCE
) -> Difference:
    a, b = measure.values(one), measure.values(other)
    if measure.rate:
        return intervals.paired_rates(a, b, confidence)
    # The seed is the study's: the same Dataset gives the same interval.
    found = intervals.paired_difference(a, b, int(one.attrs["seed"]), confidence, tested=measure.tested)
    return replace(found, median=_median(a, b, float(one.attrs["duration"]))) if measure.censored else found


def _median(a: Array, b: Array, horizon: float) -> Median:
    """Returns the median difference of times of which those at the horizon are at least that long."""
    both = np.isfinite(a + b)
    (a, b), beyond = (a[both], b[both]), (a[both] >= horizon, b[both] >= horizon)
    least, most = a - np.where(beyond[1], np.inf, b), np.where(beyond[0], np.inf, a) - b
    return intervals.median_between(least, most)


def _says_nothing(measure: PairedMeasure[Any], one: xr.Dataset, other: xr.Dataset) -> bool:
    """Tells whether two cases cannot be told equivalent: few pairs, all alike, or most of them beyond the horizon."""
    a, b = measure.values(one), measure.values(other)
    difference = (a - b)[np.isfinite(a - b)]
    if len(difference) < _FEWEST_EQUIVALENT:
        return True
    if measure.rate:
        return False
    beyond = measure.censored and any(np.nanmean(x >= float(one.attrs["duration"])) > 0.5 for x in (a, b))
    return bool(beyond) or intervals.constant(difference)


def of_factor(differences: Sequence[Paired], factor: Factor) -> list[Paired]:
    """Returns the differences between the levels of one factor."""
    return [one for one in differences if one.factor == factor]
