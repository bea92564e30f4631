"""What each robot believes of itself when it samples.

One protocol, an implementation per kind of belief; the loop cannot tell which it has.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from dynabot_mj.arrays import Array, BoolArray
from dynabot_mj.plants import FleetState
from dynabot_mj.streams import Draws, Purpose
from estimation import gauss_markov


@dataclass(frozen=True, kw_only=True)
class Belief:
    """Each robot's belief of its own state, from its latest sample."""

    position_w: Array  # (B, n, 2) [m]
    velocity_w: Array  # (B, n, 2) [m/s]

    def renewed(self, fresh: "Belief", due: BoolArray) -> "Belief":
        """Returns this belief with that of the robots that are due, (B, n), replaced by a fresh one."""
        return Belief(
            position_w=np.where(due[..., None], fresh.position_w, self.position_w),
            velocity_w=np.where(due[..., None], fresh.velocity_w, self.velocity_w),
        )


class Perception(Protocol):
    """Turns the fleet's true state into what each robot believes."""

    def observe(self, state: FleetState, due: BoolArray) -> Belief:
        """Samples the robots that are due.

        Args:
            state: True state of the fleet.
            due: Which robots sample, (B, n); what the others are given is not used.
        """
        ...


class PerfectPerception:
    """True position and velocity: the row "perfect information" of Table III."""

    def observe(self, state: FleetState, due: BoolArray) -> Belief:
        """Returns the true state."""
        return Belief(position_w=state.position_w, velocity_w=state.velocity_w)


class GaussMarkovPerception:
    """True state plus the Gauss-Markov position error of Sec. IV; the velocity is exact."""

    def __init__(
        self,
        uncertainty: float,
        correlation_time: float,
        sample_period: float,
        robots: int,
        seed: int,
        trials: Sequence[int],
    ) -> None:
        """Starts with errors from the stationary distribution.

        Args:
            uncertainty: sigma of the planar distance [m]; each axis has sigma / sqrt(2).
            correlation_time: tau [s].
            sample_period: T_s [s].
            robots: Number of robots n.
            seed: Seed of the study.
            trials: Numbers of the trials, length B.
        """
        self._sigma = uncertainty / np.sqrt(2.0)
        self._rho = gauss_markov.correlation(sample_period, correlation_time)
        self._normal = Draws(seed, trials, Purpose.ESTIMATION_ERROR, (robots, 2), normal=True)
        self._error = np.zeros((len(trials), robots, 2))
        self._started = np.zeros((len(trials), robots), dtype=bool)

    def observe(self, state: FleetState, due: BoolArray) -> Belief:
        """Returns the true state with the position off by the errors of this sample."""
        normal = self._normal.next()
        error = np.where(
            self._started[..., None],
            gauss_markov.following(self._error, self._sigma, self._rho, normal),
            gauss_markov.first(self._sigma, normal),
        )
        self._error = np.where(due[..., None], error, self._error)
        self._started = self._started | due
        return Belief(position_w=state.position_w + self._error, velocity_w=state.velocity_w)
