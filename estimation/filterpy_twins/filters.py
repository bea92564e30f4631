"""FilterPy's filters as the twins use them, and what FilterPy does not do by itself.

Its EKF moves the state by the matrix F, so `predict_x` is overridden. Its filters take whatever they are given, so an
update whose own innovation is not finite or lies beyond the gate is taken back.
"""

from typing import Any

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter, KalmanFilter

from dynabot_mj.estimation.arrays import Array
from dynabot_mj.estimation.kalman import Update

Filter = Any  # FilterPy has no types; x, P of a filter of s states are (s,), (s, s)


class MovingFilter(ExtendedKalmanFilter):  # type: ignore[misc] # FilterPy has no types
    """FilterPy's EKF, with the state moved by the model itself, not by its Jacobian."""

    moved: Array

    def __init__(self, states: int, components: int) -> None:
        """Starts at zero, in 1-D: in its default, 2-D form a 1-D z would be broadcast."""
        super().__init__(dim_x=states, dim_z=components)
        self.x = np.zeros(states)

    def predict_x(self, u: object = 0) -> None:
        """Takes what the model has found."""
        self.x = self.moved


def linear(*observation: float) -> Filter:
    """Returns FilterPy's Kalman filter of one measurement, 1-D and at zero."""
    found = KalmanFilter(dim_x=len(observation), dim_z=1)
    found.x, found.H = np.zeros(len(observation)), np.array([observation])
    return found


def judged(one: Filter, gate: float, innovation: Array, z: Array, *model: Any, **noise: Any) -> Update:
    """Lets FilterPy take a measurement, and takes it back where FilterPy's own innovation fails the gate.

    Args:
        one: The filter.
        gate: Largest NIS that is believed.
        innovation: As it is reported, (m,).
        z: The measurement, and
        *model: of an EKF its Jacobian and what it should read, as functions of x, and
        **noise: R and more, as the filter's `update` takes them.
    """
    before = one.x, one.P  # FilterPy makes new arrays at every update
    one.update(z, *model, **noise)
    squared = one.y @ one.SI @ one.y
    accepted = squared <= gate  # not so where it is NaN
    if not accepted:
        one.x, one.P = before
    return Update(
        state=one.x,
        covariance=one.P,
        innovation=innovation,
        innovation_covariance=one.S,
        squared=squared,
        accepted=accepted,
    )


def sound(one: Filter) -> bool:
    """Tells whether all numbers are finite and all variances positive, as the batched filters do."""
    variances = np.diagonal(one.P)
    return bool(np.isfinite(one.x).all() and (variances > 0.0).all() and (variances < 1e8).all())
