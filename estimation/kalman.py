"""Kalman updates of many robots at once, with a gate against outliers.

    nu = z - h(x),    S = H P H^T + R,    K = P H^T S^-1,
    x+ = x + K nu,    P+ = (I - K H) P (I - K H)^T + K R K^T    (Joseph's form: symmetric and positive for any K)

An innovation that is not finite, or whose normalised square nu^T S^-1 nu lies beyond the gate (a quantile of the
chi-square distribution), leaves state and covariance as they are.
"""

import functools
from dataclasses import dataclass

import numpy as np
from scipy import special

from dynabot_mj.estimation.arrays import Array, BoolArray


@dataclass(frozen=True, kw_only=True)
class Update:
    """What a measurement did to M robots."""

    state: Array  # (M, s) after it
    covariance: Array  # (M, s, s) after it
    innovation: Array  # nu, (M, m)
    innovation_covariance: Array  # S, (M, m, m)
    squared: Array  # normalised innovation squared (NIS), (M,); NaN where the innovation is not finite
    accepted: BoolArray  # (M,)


def taken(innovation: Array) -> Update:
    """Returns what a measurement did to a filter that takes everything and knows no covariances: NaN stands for them.

    Args:
        innovation: nu, (M, m).
    """
    count, size = innovation.shape
    return Update(
        state=np.full((count, 0), np.nan),
        covariance=np.full((count, 0, 0), np.nan),
        innovation=innovation,
        innovation_covariance=np.full((count, size, size), np.nan),
        squared=np.full(count, np.nan),
        accepted=np.ones(count, dtype=bool),
    )


@functools.cache
def threshold(share: float, components: int) -> float:
    """Returns the value that a consistent filter's NIS stays below.

    Args:
        share: Of the innovations.
        components: Of the measurement, m.
    """
    return float(2.0 * special.gammaincinv(components / 2.0, share))


def propagate(covariance: Array, jacobian: Array, noise: Array) -> Array:
    """Returns F P F^T + Q, (..., s, s)."""
    return jacobian @ covariance @ np.swapaxes(jacobian, -1, -2) + noise


def update(state: Array, covariance: Array, innovation: Array, observation: Array, noise: Array, gate: float) -> Update:
    """Takes a measurement of m components.

    Args:
        state: x, (M, s).
        covariance: P, (M, s, s).
        innovation: nu, (M, m).
        observation: H, (M, m, s).
        noise: R, (m, m) or (M, m, m).
        gate: Largest NIS that is believed.
    """
    spread = observation @ covariance  # H P
    innovation_covariance = spread @ np.swapaxes(observation, -1, -2) + noise
    inverse = np.linalg.inv(innovation_covariance)
    gain = np.swapaxes(spread, -1, -2) @ inverse
    squared = (innovation[:, None] @ inverse @ innovation[..., None])[:, 0, 0]
    accepted = squared <= gate  # not so where it is NaN
    rest = np.eye(state.shape[-1]) - gain @ observation
    shrunk = rest @ covariance @ np.swapaxes(rest, -1, -2) + gain @ noise @ np.swapaxes(gain, -1, -2)
    moved = state + (gain @ np.where(accepted[:, None], innovation, 0.0)[..., None])[..., 0]
    return Update(
        state=moved,
        covariance=np.where(accepted[:, None, None], shrunk, covariance),
        innovation=innovation,
        innovation_covariance=innovation_covariance,
        squared=squared,
        accepted=accepted,
    )


def update_one(state: Array, covariance: Array, innovation: Array, index: int, noise: float, gate: float) -> Update:
    """Takes a measurement of one state, H = e_index, by the same formulas written out.

    Args:
        state: x, (M, s).
        covariance: P, (M, s, s).
        innovation: nu, (M,).
        index: Of the state that is measured.
        noise: R.
        gate: Largest NIS that is believed.
    """
    column = covariance[..., index]
    innovation_variance = column[..., index] + noise
    squared = innovation**2 / innovation_variance
    accepted = squared <= gate
    gain = np.where(accepted, 1.0 / innovation_variance, 0.0)[:, None] * column
    # (I - K H) P (I - K H)^T + K R K^T = P - K c^T - c K^T + K S K^T with c = P e_index
    crossed = gain[..., :, None] * column[..., None, :]
    shrunk = covariance - crossed - np.swapaxes(crossed, -1, -2)
    shrunk += innovation_variance[:, None, None] * (gain[..., :, None] * gain[..., None, :])
    return Update(
        state=state + gain * np.where(accepted, innovation, 0.0)[:, None],
        covariance=shrunk,
        innovation=innovation[:, None],
        innovation_covariance=innovation_variance[:, None, None],
        squared=squared,
        accepted=accepted,
    )
