"""What each robot believes of itself when it samples: one protocol, so that the loop cannot tell which kind it has."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.plants.plant import FleetState, NavigationError


@dataclass(frozen=True, kw_only=True)
class Belief:
    """Each robot's belief of its own state, from its latest sample."""

    position_w: Array  # (B, n, 2) [m]
    velocity_w: Array  # (B, n, 2) [m/s]
    position_covariance: Array  # (B, n, 2, 2) as the robot believes it [m^2]
    known: BoolArray  # (B, n) whether it knows where it is at all; one that does not neither acts nor broadcasts
    stale: BoolArray  # (B, n) whether it has been carried on without a fix for long
    restarts: npt.NDArray[np.int64]  # (B, n) times that an estimator broke down and was started again

    def renewed(self, fresh: "Belief", due: BoolArray) -> "Belief":
        """Returns this belief with that of the robots that are due, (B, n), replaced by a fresh one."""
        if due.all():  # as at every sample of robots that share a clock
            return fresh
        return Belief(
            position_w=np.where(due[..., None], fresh.position_w, self.position_w),
            velocity_w=np.where(due[..., None], fresh.velocity_w, self.velocity_w),
            position_covariance=np.where(due[..., None, None], fresh.position_covariance, self.position_covariance),
            known=np.where(due, fresh.known, self.known),
            stale=np.where(due, fresh.stale, self.stale),
            restarts=np.where(due, fresh.restarts, self.restarts),
        )


def certain(position_w: Array, velocity_w: Array, variance: float = 0.0) -> Belief:
    """Returns the belief of robots that know their state, or how wrong their positions are.

    Args:
        position_w: (B, n, 2) [m].
        velocity_w: (B, n, 2) [m/s].
        variance: Of the positions' errors, per axis [m^2].
    """
    shape = position_w.shape[:2]
    return Belief(
        position_w=position_w,
        velocity_w=velocity_w,
        position_covariance=np.broadcast_to(variance * np.eye(2), (*shape, 2, 2)),
        known=np.ones(shape, dtype=bool),
        stale=np.zeros(shape, dtype=bool),
        restarts=np.zeros(shape, dtype=np.int64),
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

    def substep(self, state: FleetState) -> None:
        """Takes a true state between samples: sensors have rates of their own."""
        ...

    def navigation_error(self, time: float) -> NavigationError | None:
        """Returns what the local laws' signals are off by at a time [s]; None: they are ideal."""
        ...
