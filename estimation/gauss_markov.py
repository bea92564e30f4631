"""The steady-state Gauss-Markov error that stands for an estimator, Sec. IV of the paper.

    e_0 = sigma w_0,        e_{k+1} = rho e_k + sigma sqrt(1 - rho^2) w_k,        rho = exp(-T / tau),

with independent standard normal w_k, so that E[e_k^2] = sigma^2 at every k, the first included ("steady state"), and
E[e_k e_{k+m}] = sigma^2 rho^m. The paper gives sigma (Table II) and neither the correlation time tau nor whether
sigma is the deviation per axis or of the planar distance; both are the caller's choice.
"""

import math
from dataclasses import dataclass

from dynabot_mj.estimation.arrays import Array


@dataclass(frozen=True, kw_only=True)
class Component:
    """One sequence of an error that is the sum of several."""

    deviation: float  # sigma, in the error's unit
    time: float  # tau [s]


def correlation(period: float, correlation_time: float) -> float:
    """Returns rho = exp(-T / tau), the correlation of two successive errors.

    Args:
        period: Time T between them [s].
        correlation_time: tau [s].
    """
    return math.exp(-period / correlation_time)


def first(sigma: float, normal: Array) -> Array:
    """Returns errors drawn from the stationary distribution.

    Args:
        sigma: Standard deviation of each component [m].
        normal: Independent standard normal numbers, any shape.

    Returns:
        Errors of the same shape [m].
    """
    return sigma * normal


def following(error: Array, sigma: float, rho: float, normal: Array) -> Array:
    """Returns the errors one period later.

    Args:
        error: The errors now, any shape [m].
        sigma: Standard deviation of each component [m].
        rho: Correlation of successive errors, from `correlation`.
        normal: Independent standard normal numbers of the same shape.

    Returns:
        Errors of the same shape and variance [m].
    """
    return rho * error + sigma * math.sqrt(1.0 - rho * rho) * normal


@dataclass(frozen=True, kw_only=True)
class PeriodMean:
    """The mean of a sequence's continuous process over a period, given its values at both ends.

    For the Ornstein-Uhlenbeck process of unit variance and x = T / tau, the mean m of a period between the values a
    and b is Gaussian with

        E[m | a, b] = (a + b) tanh(x / 2) / x,
        Var[m | a, b] = 2 (x - 1 + e^{-x}) / x^2 - 2 (1 + e^{-x}) (tanh(x / 2) / x)^2,

    the variance of the mean less that of its expectation. The mean of the ends alone would vary too little, the more
    the longer the period.
    """

    weight: float  # of the sum of both ends
    deviation: float  # of what is left, for a process of unit variance

    def between(self, before: Array, after: Array, sigma: float, normal: Array) -> Array:
        """Returns the means over a period.

        Args:
            before: Values at its beginning, any shape.
            after: Values at its end, of the same shape.
            sigma: Standard deviation of the values, in their unit.
            normal: Independent standard normal numbers of the same shape.

        Returns:
            Means of the same shape and unit.
        """
        return self.weight * (before + after) + sigma * self.deviation * normal


def period_mean(period: float, correlation_time: float) -> PeriodMean:
    """Returns how the mean over a period depends on its ends.

    Args:
        period: T [s].
        correlation_time: tau [s].
    """
    x = period / correlation_time
    weight = math.tanh(0.5 * x) / x
    variance = 2.0 * (x + math.expm1(-x)) / x**2 - 2.0 * (1.0 + math.exp(-x)) * weight**2
    return PeriodMean(weight=weight, deviation=math.sqrt(max(variance, 0.0)))
