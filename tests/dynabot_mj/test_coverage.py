"""How often the intervals hold what they are of: `pytest -s -m slow tests/dynabot_mj/test_coverage.py` prints it.

Rates and paired rates by exact enumeration of all outcomes of 100 trials; means by drawing 100 trials from a study of
many, whose mean is the truth.
"""

import functools

import numpy as np
import pytest
from scipy import stats

from dynabot_mj import configuration, statistics, study
from dynabot_mj.execution import Execution
from dynabot_mj.experiments import measures

N = 100
RATES = (0.02, 0.1, 0.5)
DRAWS = 1000
POPULATION = 600


@pytest.mark.slow
@pytest.mark.parametrize("p", RATES)
def test_wilson_intervals_of_rates(p):
    k = np.arange(N + 1)
    intervals = [statistics.share(int(one), N) for one in k]
    inside = np.array([one.low <= p <= one.high for one in intervals])
    coverage = float((stats.binom.pmf(k, N, p) * inside).sum())
    print(f"\nrate {p}: {100 * coverage:.1f} %")
    assert coverage >= 0.93


@functools.cache
def interval(more, less):
    return statistics.paired_rates_interval(more, less, N)


@pytest.mark.slow
@pytest.mark.parametrize("p", RATES)
@pytest.mark.parametrize("share", [0.2, 0.5, 1.0])
@pytest.mark.parametrize("difference", [0.0, 0.05, 0.2])
def test_intervals_of_paired_rates(p, difference, share):
    """Rates p and p + difference; the share is that of the discordant pairs beyond the least, 1 being independence."""
    only_second = difference + share * p * (1.0 - p - difference)
    only_first = only_second - difference
    coverage = 0.0
    for more in range(N + 1):
        for less in range(N + 1 - more):
            chance = stats.multinomial.pmf(
                [more, less, N - more - less], N, [only_first, only_second, 1.0 - only_first - only_second]
            )
            if chance > 1e-9:
                low, high = interval(more, less)
                coverage += chance * (low <= -difference <= high)
    discordant = only_first + only_second
    print(f"\nrates {p} and {p + difference:g}, discordant {discordant:.3f}: {100 * coverage:.1f} %")
    assert coverage >= 0.93


@pytest.fixture(scope="module")
def population():
    setup = configuration.build(
        {},
        trials=POPULATION,
        plants=["particle"],
        estimators=["gps", "decoupled", "coupled"],
        perception=["gauss-markov"],
    )
    return study.run(setup, Execution(workers=2))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["arrival_s", "time_to_formation_s", "in_band_fraction"])
@pytest.mark.parametrize(("a", "b"), [(0, None), (1, None), (2, None), (0, 1), (1, 2)])
def test_bca_intervals_of_means_on_the_studys_own_distributions(population, name, a, b):
    measure = next(one for one in measures.MEASURES if one.name == name)
    values = measure.values(population.isel(case=a))
    if b is not None:
        values = values - measure.values(population.isel(case=b))
    values = values[np.isfinite(values)]
    truth, rng = values.mean(), np.random.default_rng(0)
    found = [statistics.bootstrapped(rng.choice(values, N), seed) for seed in range(DRAWS)]
    coverage = np.mean([one.low <= truth <= one.high for one in found])
    of = population.estimator.values[a] + ("" if b is None else f" - {population.estimator.values[b]}")
    print(f"\n{name} of {of}: {100 * coverage:.1f} %, skewness {stats.skew(values):.1f}")
    # A thousand draws tell 90 % within 0.9 points; the bound of 90 % is of the intervals, two of these below it.
    assert coverage >= 0.90 - 2.0 * 0.0095
