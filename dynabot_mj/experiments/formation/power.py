"""How many trials a difference needs: from a pilot study to the trials of the study that will be concluded from.

The pilot tells how cases vary on the same trials; how large a difference matters is the user's to say. Its own estimate
stands in where nothing is said, and is told with the trials at the ends of its interval, since it is a noisy one.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import xarray as xr

from dynabot_mj.common import intervals
from dynabot_mj.common.arrays import Array
from dynabot_mj.common.intervals import Difference, Rate
from dynabot_mj.experiments.formation import paired_tests, power_laws, power_request
from dynabot_mj.experiments.formation.measure import PairedMeasure
from dynabot_mj.experiments.formation.measures import PAIRED
from dynabot_mj.experiments.formation.power_request import Request

_SIMULATED, _EXACT = 13, 50  # numbers of trials whose power is told
_STUDIES = 2_000  # that they are simulated by

Origin = Literal["given", "pilot", "low", "high"]


@dataclass(frozen=True, kw_only=True)
class Need:
    """How many trials a difference needs."""

    origin: Origin  # low, high: ends of the interval of the pilot's own
    difference: float
    discordant: float | None  # share of the pairs, of rates
    raised: bool  # the pilot's share was smaller than the difference
    pairs: int | None  # with a value in both cases; None: more than are told, or none is enough where there is nothing
    trials: int | None  # of which as many as in the pilot have a value in both cases
    power: Rate | None  # at that number; of studies that were simulated, n = 0: exact


@dataclass(frozen=True, kw_only=True)
class Point:
    """The power of a number of trials."""

    trials: int
    power: float
    low: float | None  # of the interval, where it is simulated
    high: float | None


@dataclass(frozen=True, kw_only=True)
class Variances:
    """What common random numbers save for two cases."""

    a: str
    b: str
    n: int
    variance_a: float
    variance_b: float
    variance_difference: float
    ratio: float | None  # of the first two to the third; None where that is nothing


@dataclass(frozen=True, kw_only=True)
class Plan:
    """What a pilot says of the trials that are needed."""

    request: Request
    measure: PairedMeasure[Any]
    pilot_trials: int
    estimate: Difference  # of the pilot
    discordant: Rate | None  # of its pairs, of rates
    alpha: float  # of each comparison
    needs: Sequence[Need]  # the first is what was asked for
    unpaired_trials: int | None  # of each case, without common random numbers
    curve: Sequence[Point]  # of the first
    variances: Sequence[Variances]  # of the two cases, and of all others that are compared by the measure


def planned(study: xr.Dataset, request: Request) -> Plan:
    """Tells how many trials a difference needs.

    Args:
        study: The pilot: cases x trials.
        request: What is asked.

    Raises:
        InputError: If it is nothing that could be told, or the pilot says too little.
    """
    measure = power_request.judge(study, request)
    alpha = request.alpha / request.comparisons
    one, other = (study.sel(case=name) for name in (request.a, request.b))
    a, b = measure.values(one), measure.values(other)
    differences = power_request.differences(measure, request, a, b)
    if measure.rate:
        estimate = intervals.paired_rates(a, b)
    else:
        estimate = intervals.paired_difference(a, b, int(study.attrs["seed"]), tested=False)
    share = len(differences) / len(a)
    law = _Law(differences, measure.rate, alpha, int(study.attrs["seed"]))
    needs = [law.need(origin, value, request.power, share) for origin, value in _wanted(study, request, estimate)]
    variances = _variances(study, measure, request)
    ratio, trials = variances[0].ratio, needs[0].trials
    return Plan(
        request=request,
        measure=measure,
        pilot_trials=len(a),
        estimate=estimate,
        discordant=intervals.rate(differences != 0.0) if measure.rate else None,
        alpha=alpha,
        needs=needs,
        unpaired_trials=None if ratio is None or trials is None else math.ceil(ratio * trials),
        curve=law.curve(needs[0], share),
        variances=variances,
    )


class _Law:
    """The power of the measure's test, by the pilot's differences."""

    def __init__(self, differences: Array, rate: bool, alpha: float, seed: int) -> None:
        self._differences, self._rate, self._alpha, self._seed = differences, rate, alpha, seed
        self._spread = float(np.mean(differences != 0.0))  # share of discordant pairs, of rates

    def need(self, origin: Origin, difference: float, power: float, share: float) -> Need:
        """Returns the trials that a difference needs, where a share of them has a value in both cases."""
        discordant = max(self._spread, abs(difference)) if self._rate else None
        need = Need(
            origin=origin,
            difference=difference,
            discordant=discordant,
            raised=discordant is not None and discordant > self._spread + power_request.ROUNDING,
            pairs=None,
            trials=None,
            power=None,
        )
        if difference == 0.0:
            return need
        if discordant is not None:
            more, less = self._shares(difference)
            pairs = power_laws.mcnemar_pairs(more, less, self._alpha, power)
        else:
            pairs = power_laws.sign_flip_pairs(self._shifted(difference), self._alpha, power, self._seed)
        if pairs is None:
            return need
        return replace(need, pairs=pairs, trials=math.ceil(pairs / share), power=self._power(difference, pairs))

    def curve(self, need: Need, share: float) -> list[Point]:
        """Returns the power at numbers of trials around the one that is needed."""
        middle = power_laws.MOST if need.pairs is None else need.pairs
        points = _EXACT if self._rate else _SIMULATED
        numbers = np.linspace(max(2, middle // 4), min(power_laws.MOST, 2 * middle + 2), points)
        found = []
        for pairs in sorted({*map(int, numbers.round()), middle}):
            if pairs == need.pairs and need.power is not None:
                power = need.power
            else:
                power = self._power(need.difference, pairs, _STUDIES)
            assert power.rate is not None
            found.append(Point(trials=math.ceil(pairs / share), power=power.rate, low=power.low, high=power.high))
        return found

    def _power(self, difference: float, pairs: int, studies: int = power_laws.STUDIES) -> Rate:
        if self._rate:
            exact = power_laws.mcnemar(pairs, *self._shares(difference), self._alpha)
            return Rate(rate=exact, low=None, high=None, k=0, n=0)
        return power_laws.sign_flips(self._shifted(difference), pairs, self._alpha, self._seed, studies)

    def _shares(self, difference: float) -> tuple[float, float]:
        """Returns the probabilities of a pair that is discordant either way, first that of the difference's sign."""
        discordant = max(self._spread, abs(difference))
        return (discordant + abs(difference)) / 2.0, (discordant - abs(difference)) / 2.0

    def _shifted(self, difference: float) -> Array:
        """Returns the pilot's differences about another mean, turned so that it is positive."""
        centred = self._differences - self._differences.mean()
        return math.copysign(1.0, difference) * (centred + difference)


def _wanted(study: xr.Dataset, request: Request, estimate: Difference) -> list[tuple[Origin, float]]:
    """Returns the differences whose trials are told: the one that is given, or the pilot's own and its interval."""
    if request.difference is not None:
        scale = next(one.scale for one in PAIRED if one.name == request.measure)
        return [("given", request.difference / scale)]
    middle, low, high = estimate.difference, estimate.low, estimate.high
    assert middle is not None
    assert low is not None
    assert high is not None
    if low <= 0.0 <= high:  # the end of the other sign is not what is looked for: on the way to it there is nothing
        low, high = (0.0, high) if middle > 0.0 else (low, 0.0)
    return [("pilot", middle), ("low", low), ("high", high)]


def _variances(study: xr.Dataset, measure: PairedMeasure[Any], request: Request) -> list[Variances]:
    """Returns what common random numbers save, of the two cases first."""
    asked = (request.a, request.b)
    names = [asked]
    for factor in measure.factors:
        for pair in paired_tests.pairs(study, factor):
            one, other = (str(case.case.item()) for case in pair)
            if {one, other} != set(asked):
                names.append((one, other))
    saved = [_saved(study, measure, *pair) for pair in names]
    return [one for one in saved if one is not None]


def _saved(study: xr.Dataset, measure: PairedMeasure[Any], a: str, b: str) -> Variances | None:
    """Returns the variances of two cases; None where they have too few pairs."""
    first, second = (measure.values(study.sel(case=name)) for name in (a, b))
    both = np.isfinite(first + second)
    first, second = first[both], second[both]
    if len(first) < power_request.FEWEST:
        return None
    of_a, of_b, of_difference = (float(values.var(ddof=1)) for values in (first, second, first - second))
    nothing = of_difference <= power_request.ROUNDING * max(1.0, of_a + of_b)
    return Variances(
        a=a,
        b=b,
        n=len(first),
        variance_a=of_a,
        variance_b=of_b,
        variance_difference=of_difference,
        ratio=None if nothing else (of_a + of_b) / of_difference,
    )
