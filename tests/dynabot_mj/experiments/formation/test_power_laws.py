import itertools
import math

import numpy as np
import pytest
from scipy import stats

from dynabot_mj.common import intervals
from dynabot_mj.experiments.formation import power_laws

DESIGNS = [(0.3, 0.1), (0.05, 0.01), (0.2, 0.0), (0.55, 0.45), (0.12, 0.07)]  # shares of discordant pairs


def skewed(difference):
    """Differences of which a few are far from all others, about a mean."""
    values = np.concatenate([stats.norm.ppf((np.arange(48) + 0.5) / 48), [12.0, 15.0]])
    return values - values.mean() + difference


@pytest.mark.parametrize(("more", "less"), [(0.5, 0.2), (0.6, 0.0), (0.7, 0.3)])
@pytest.mark.parametrize("alpha", [0.05, 0.3])
def test_the_exact_power_is_that_of_all_studies_there_are(more, less, alpha):
    pairs, found = 7, 0.0
    chances = {1.0: more, -1.0: less, 0.0: 1.0 - more - less}
    verdicts = {}
    for study in itertools.product(chances, repeat=pairs):
        kind = (study.count(1.0), study.count(-1.0))
        if kind not in verdicts:
            told = intervals.paired_rates(np.array(study), np.zeros(pairs))
            verdicts[kind] = told.p < alpha and told.difference > 0.0
        found += verdicts[kind] * math.prod(chances[one] for one in study)
    assert power_laws.mcnemar(pairs, more, less, alpha) == pytest.approx(found, abs=1e-12)


@pytest.mark.parametrize(("more", "less"), DESIGNS)
def test_from_the_number_of_pairs_on_no_number_has_less_power(more, less):
    pairs = power_laws.mcnemar_pairs(more, less, 0.05, 0.8)
    later = [power_laws.mcnemar(one, more, less, 0.05) for one in range(pairs, pairs + 300)]
    assert min(later) >= 0.8 > power_laws.mcnemar(pairs - 1, more, less, 0.05)


def test_a_number_of_pairs_after_which_the_power_falls_again_is_not_enough():
    pairs = power_laws.mcnemar_pairs(0.8, 0.2, 0.05, 0.8)  # all pairs are discordant: the power is most sawtooth
    earlier = [one for one in range(2, pairs) if power_laws.mcnemar(one, 0.8, 0.2, 0.05) >= 0.8]
    assert earlier
    assert pairs - 1 not in earlier


@pytest.mark.parametrize(("more", "less"), DESIGNS)
@pytest.mark.parametrize("power", [0.8, 0.95])
def test_the_number_of_pairs_is_near_connors(more, less, power):
    # Connor (1987): a normal approximation, which is rough where few pairs are discordant.
    discordant, difference = more + less, more - less
    bound, reach = stats.norm.isf(0.025), stats.norm.ppf(power)
    connor = ((bound * discordant**0.5 + reach * (discordant - difference**2) ** 0.5) / difference) ** 2
    assert power_laws.mcnemar_pairs(more, less, 0.05, power) == pytest.approx(connor, rel=0.16)


def test_more_pairs_than_are_told_are_none():
    assert power_laws.mcnemar_pairs(0.3001, 0.2999, 0.05, 0.8) is None
    assert power_laws.sign_flip_pairs(skewed(0.005), 0.05, 0.8, 0) is None


@pytest.mark.parametrize("pairs", [7, 13, 14, 25])
def test_studies_are_found_as_the_comparison_would_find_them(pairs):
    drawn = np.random.default_rng(3).choice(skewed(1.0), size=(25, pairs))
    found = power_laws._flipped(drawn, 0.05, np.random.default_rng(4))
    told = [intervals.paired_difference(one, np.zeros(pairs), seed=5) for one in drawn]
    p = np.array([one.p for one in told])
    expected = (p < 0.05) & (np.array([one.difference for one in told]) > 0.0)
    # All flips are the same flips; of random ones, p is twice a share near 0.025 of 9,999: both have a standard error
    # of 0.003, their difference one of 0.0045, of which five are allowed.
    clear = np.abs(p - 0.05) > (0.0 if pairs <= 13 else 0.0225)
    assert clear.sum() > 15
    assert (found == expected)[clear].all()


def test_the_sum_of_many_flips_is_normal(monkeypatch):
    flipped = power_laws.sign_flips(skewed(0.25), 400, 0.05, 1)
    monkeypatch.setattr(power_laws, "_MOST_FLIPPED", 399)
    normal = power_laws.sign_flips(skewed(0.25), 400, 0.05, 1)
    # Two shares of 10,000 independent studies: a standard error of at most 0.0071, of which four are allowed.
    assert 0.2 < flipped.rate < 0.8
    assert normal.rate == pytest.approx(flipped.rate, abs=0.03)


def test_the_power_of_no_difference_is_half_of_alpha():
    centred = stats.norm.ppf((np.arange(50) + 0.5) / 50)
    found = power_laws.sign_flips(centred, 40, 0.05, 2)
    assert found.rate == pytest.approx(0.025, abs=0.0065)  # four standard errors of 10,000 studies
    assert (found.n, found) == (power_laws.STUDIES, power_laws.sign_flips(centred, 40, 0.05, 2))


@pytest.mark.parametrize("difference", [0.3, 0.55])
def test_the_number_of_pairs_is_near_the_normal_one_where_differences_are_normal(difference):
    values = stats.norm.ppf((np.arange(80) + 0.5) / 80) + difference
    pairs = power_laws.sign_flip_pairs(values, 0.05, 0.8, 0)
    # A t test needs about two pairs more than the normal approximation, and the interval above the target about 3 %.
    normal = power_laws.normal_pairs(values, 0.05, 0.8)
    assert normal <= pairs <= 1.04 * normal + 4
    assert power_laws.sign_flips(values, pairs, 0.05, 0).low >= 0.8
    assert power_laws.sign_flips(values, int(0.95 * pairs), 0.05, 0).low < 0.8


def test_no_fewer_pairs_are_told_than_a_p_value_needs():
    # 2 / 2^6 is below 0.05, 2 / 2^5 is not.
    assert power_laws.sign_flip_pairs(skewed(1000.0), 0.05, 0.8, 0) == 6
    assert power_laws.sign_flip_pairs(skewed(1000.0), 0.001, 0.8, 0) == 11


def found_of(drawn, test):
    told = [test(one) for one in drawn]
    return sum(one.p < 0.05 and one.difference > 0.0 for one in told)


def covered(found, studies, most):
    """Whether a power of 0.8 is kept: by four standard errors of so many studies, which 3 of 100,000 would miss.

    It is not much more either, so that the number is none that is simply too large.
    """
    error = (0.8 * 0.2 / studies) ** 0.5
    return 0.8 - 4.0 * error <= found / studies <= most + 4.0 * error


@pytest.mark.parametrize("studies", [500, pytest.param(10_000, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("more", "less"), DESIGNS[:4])
def test_the_power_that_is_promised_of_rates_is_that_of_many_studies(more, less, studies):
    pairs = power_laws.mcnemar_pairs(more, less, 0.05, 0.8)
    drawn = np.random.default_rng(pairs).random((studies, pairs))
    kinds = (drawn < more) * 1.0 - (drawn >= 1.0 - less)
    found = found_of(kinds, lambda one: intervals.paired_rates(one > 0.0, one < 0.0))
    # Exact numbers of discordant pairs are coarse: the power at the smallest number is up to 2 % more.
    assert covered(found, studies, 0.82)


@pytest.mark.parametrize("studies", [40, pytest.param(1_500, marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "values", [stats.norm.ppf((np.arange(60) + 0.5) / 60) + 0.5, skewed(1.2)], ids=["normal", "skewed"]
)
def test_the_power_that_is_promised_of_means_is_that_of_many_studies(values, studies):
    pairs = power_laws.sign_flip_pairs(values, 0.05, 0.8, 0)
    drawn = np.random.default_rng(pairs).choice(values, size=(studies, pairs))
    found = found_of(drawn, lambda one: intervals.paired_difference(one, np.zeros(pairs)))
    # The number is one whose interval is above 0.8, half a width of 0.008, and the next that was tried is not.
    assert covered(found, studies, 0.83)
