"""Where robots are at the end of each control period, of trials whose robots sample and act at once."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.plants.plant import FleetState, Plant
from dynabot_mj.trial import loop
from dynabot_mj.trial.loop import Event, Observer, Parts


@dataclass(frozen=True, kw_only=True)
class PeriodEnds:
    """The start, and the ends of K control periods."""

    time: Array  # (K + 1,) [s]
    position_w: Array  # (K + 1, B, n, 2) [m]
    velocity_w: Array  # (K + 1, B, n, 2) [m/s]
    heading: Array  # (K + 1, B, n), not wrapped [rad]
    diverged: BoolArray  # (K + 1, B) by then


def drive(parts: Parts, observers: Sequence[Observer] = ()) -> PeriodEnds:
    """Runs trials and keeps the ends of their periods.

    Args:
        parts: What they are made of, with one period for sampling and control.
        observers: Are shown everything as well.
    """
    kept = _Keeper(parts.plant)
    loop.simulate(parts, [kept, *observers])
    kept.keep(parts.plant.state)
    return PeriodEnds(
        time=np.array([state.time for state in kept.states]),
        position_w=np.stack([state.position_w for state in kept.states]),
        velocity_w=np.stack([state.velocity_w for state in kept.states]),
        heading=np.stack([state.heading for state in kept.states]),
        diverged=np.stack(kept.diverged),
    )


class _Keeper:
    def __init__(self, plant: Plant) -> None:
        self._plant = plant
        self.states: list[FleetState] = []
        self.diverged: list[BoolArray] = []

    def event(self, event: Event) -> None:
        """Takes the end of a period, or the start."""
        self.keep(event.state)

    def substep(self, state: FleetState) -> None:
        """Takes a state, of which nothing is kept."""

    def keep(self, state: FleetState) -> None:
        """Keeps a state."""
        self.states.append(state)
        self.diverged.append(self._plant.diverged.copy())
