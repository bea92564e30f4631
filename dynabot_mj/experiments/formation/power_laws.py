"""How often the paired tests of `common.intervals` find a difference, by the number of pairs.

paired rates  McNemar's exact test, exactly: discordant pairs are binomial of all pairs, and those of the first
              condition are binomial of them. The power of exact tests is sawtooth, so a number of pairs is told from
              which on no larger one has less power than is asked for.
paired means  The sign-flip permutation test, by simulation: studies drawn with replacement from the differences of a
              pilot. The number of pairs is one whose simulated power is above what is asked for with its interval.

A difference is found where p is below alpha and its sign is right.
"""

import functools
import math

import numpy as np
from scipy import stats

from dynabot_mj.common import intervals
from dynabot_mj.common.arrays import Array
from dynabot_mj.common.intervals import RESAMPLES, Rate

MOST = 100_000  # pairs that are told
STUDIES = 10_000  # that a power is simulated by
SMALLEST_P = 2.0 / RESAMPLES  # that random sign flips can tell

_FIRST_FLIPS = 500  # after which, and after twice as many each time, clear studies are decided
_DOUBT = 1e-4  # of a study that is decided before its last flip
_MOST_FLIPPED = 1_000  # pairs, beyond which the sum of random flips is normal
_AT_ONCE = 500  # studies, all of whose flips are tried
_RESOLUTION = 0.01  # of a number of pairs that is found by simulation


def mcnemar(pairs: int, more: float, less: float, alpha: float) -> float:
    """Returns the power of McNemar's exact test.

    Args:
        pairs: Their number, at most `MOST`.
        more: Probability that a pair has a one in the condition only that has more of them.
        less: That it has a one in the other condition only.
        alpha: Below which p is a finding.
    """
    discordant = min(1.0, more + less)  # but for rounding
    return _mixed(pairs, discordant, _found(more / discordant, alpha))


def mcnemar_pairs(more: float, less: float, alpha: float, power: float) -> int | None:
    """Returns the smallest number from which on all have the power; None where it is beyond `MOST`.

    Args:
        more: As in `mcnemar`.
        less: As in `mcnemar`.
        alpha: As in `mcnemar`.
        power: That is asked for.
    """
    discordant = min(1.0, more + less)
    found = _found(more / discordant, alpha)
    # What any larger number of discordant pairs finds at least. It never falls, so its mean over their binomial number
    # never falls with the pairs either: where that is enough, it is enough for all larger numbers.
    least = np.minimum.accumulate(found[::-1])[::-1]
    if _mixed(MOST, discordant, least) < power:
        return None
    short, enough = 0, MOST
    while enough - short > 1:
        middle = (short + enough) // 2
        short, enough = (short, middle) if _mixed(middle, discordant, least) >= power else (middle, enough)
    while _mixed(enough - 1, discordant, found) >= power:
        enough -= 1
    return enough


def sign_flips(differences: Array, pairs: int, alpha: float, seed: int, studies: int = STUDIES) -> Rate:
    """Returns the simulated power of the permutation test that the mean is positive, with its interval.

    Args:
        differences: That pairs are drawn from, (values,), without NaN.
        pairs: Of each study.
        alpha: Below which p is a finding.
        seed: Of all random numbers.
        studies: How many are drawn.
    """
    generator = np.random.default_rng((seed, pairs))
    if pairs > _MOST_FLIPPED:
        counts = generator.multinomial(pairs, np.full(len(differences), 1.0 / len(differences)), size=studies)
        total, spread = counts @ differences, np.sqrt(counts @ differences**2)
        found = total > stats.norm.isf(0.5 * alpha) * spread
    else:
        found = _flipped(generator.choice(differences, size=(studies, pairs)), alpha, generator)
    return intervals.share(int(found.sum()), studies)


def sign_flip_pairs(differences: Array, alpha: float, power: float, seed: int) -> int | None:
    """Returns the smallest number of pairs, to 1 %, whose simulated power is above what is asked for with its interval.

    None where it is beyond `MOST`.

    Args:
        differences: As in `sign_flips`; their mean is positive.
        alpha: As in `sign_flips`.
        power: That is asked for.
        seed: As in `sign_flips`.
    """

    def enough(pairs: int) -> bool:
        low = sign_flips(differences, pairs, alpha, seed).low
        return low is not None and low >= power

    # No fewer pairs have flips enough for such a p.
    smallest = math.floor(math.log2(2.0 / alpha)) + 1
    short, end = smallest - 1, max(smallest, min(MOST, normal_pairs(differences, alpha, power)))
    while not enough(end):
        if end == MOST:
            return None
        short, end = end, min(MOST, math.ceil(1.1 * end))
    begin = math.floor(0.9 * end)
    if begin > short:  # the normal approximation is near: most of what is below it need not be tried
        short, end = (begin, end) if not enough(begin) else (short, begin)
    while end - short > max(1.0, _RESOLUTION * end):
        middle = (short + end) // 2
        short, end = (short, middle) if enough(middle) else (middle, end)
    return end


def normal_pairs(differences: Array, alpha: float, power: float) -> int:
    """Returns the number of pairs by the normal approximation, which knows no skewness; at least 1."""
    quantiles = float(stats.norm.isf(0.5 * alpha) + stats.norm.ppf(power))
    share = quantiles**2 * float(differences.var(ddof=1)) / float(differences.mean()) ** 2
    return max(1, math.ceil(min(share, 10.0 * MOST)))


@functools.lru_cache(maxsize=4)
def _critical(alpha: float) -> Array:
    """Returns the largest count of the rarer kind with p below alpha, by the number of discordant pairs; -1: none."""
    found: Array = stats.binom.ppf(0.5 * alpha, np.arange(MOST + 1), 0.5) - 1.0
    return found


@functools.lru_cache(maxsize=4)
def _found(share: float, alpha: float) -> Array:
    """Returns the power by the number of discordant pairs, of which `share` are of the first condition."""
    found: Array = stats.binom.cdf(_critical(alpha), np.arange(MOST + 1), 1.0 - share)
    return found


def _mixed(pairs: int, discordant: float, values: Array) -> float:
    """Returns the mean of values over the binomial number of discordant pairs."""
    mean, reach = pairs * discordant, 10.0 + 10.0 * math.sqrt(pairs * discordant)  # beyond it there is next to nothing
    counts = np.arange(max(0, math.floor(mean - reach)), min(pairs, math.ceil(mean + reach)) + 1)
    return float(stats.binom.pmf(counts, pairs, discordant) @ values[counts])


def _slices(studies: int) -> list[slice]:
    """Returns parts of the studies whose flips take little memory."""
    return [slice(start, start + _AT_ONCE) for start in range(0, studies, _AT_ONCE)]


def _flipped(drawn: Array, alpha: float, generator: np.random.Generator) -> Array:
    """Returns which studies, (studies, pairs), are found by `intervals.paired_difference`'s test to be positive.

    As there, all flips are taken where they are no more than `RESAMPLES`, else random ones. All studies share them,
    and a study is decided as soon as hardly any further flips could change it.
    """
    studies, pairs = drawn.shape
    total = drawn.sum(axis=1)
    bound = total - 1e-12 * np.abs(drawn).sum(axis=1)  # sums that differ by rounding only are equal
    if 2**pairs < RESAMPLES:
        flips = 1.0 - 2.0 * ((np.arange(2**pairs)[:, None] >> np.arange(pairs)) & 1)
        parts = [(drawn[one] @ flips.T >= bound[one, None]).mean(axis=1) for one in _slices(studies)]
        return (2.0 * np.concatenate(parts) < alpha) & (total > 0.0)
    last = RESAMPLES - 1
    found, open_ = np.zeros(studies, dtype=bool), np.flatnonzero(total > 0.0)
    beyond, done, block = np.zeros(studies), 0, _FIRST_FLIPS
    while done < last and len(open_):
        block = min(block, last - done)
        flips = 1.0 - 2.0 * generator.integers(0, 2, size=(pairs, block))
        beyond[open_] += (drawn[open_] @ flips >= bound[open_, None]).sum(axis=1)
        done += block
        block = done
        if done == last:
            found[open_] = 2.0 * (beyond[open_] + 1.0) / (last + 1.0) < alpha
        else:
            few, many = stats.binom.ppf([_DOUBT, 1.0 - _DOUBT], done, 0.5 * alpha)
            found[open_] = beyond[open_] < few
            open_ = open_[(beyond[open_] >= few) & (beyond[open_] <= many)]
    return found
