"""The steady-state Gauss-Markov error that stands for an estimator, Sec. IV of the paper.

    e_0 = sigma w_0,        e_{k+1} = rho e_k + sigma sqrt(1 - rho^2) w_k,        rho = exp(-T / tau),

with independent standard normal w_k, so that E[e_k^2] = sigma^2 at every k, the first included ("steady state"), and
E[e_k e_{k+m}] = sigma^2 rho^m. The paper gives sigma (Table II) and neither the correlation time tau nor whether
sigma is the deviation per axis or of the planar distance; both are the caller's choice.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


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
