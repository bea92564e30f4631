"""The common band of all methods, while trials run; `dynabot_mj.formation.metrics` defines it."""

import numpy as np

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.formation.geometry import neighbour_distances
from dynabot_mj.formation.metrics import COMMON_TOLERANCE, HOLDING, Formation
from dynabot_mj.plants.plant import FleetState


class Band:
    """Which trials are in the band, for how long in all, and when it began to hold."""

    def __init__(self, formation: Formation, leader_w: Array, trials: int) -> None:
        """Has seen nothing yet.

        Args:
            formation: What to judge against.
            leader_w: Position of the leader, (2,) [m].
            trials: B.
        """
        self._formation, self._leader_w = formation, leader_w
        self._since = np.full(trials, np.nan)  # it holds; NaN where it does not
        self.formed = np.full(trials, np.nan)  # when it began to hold for long enough, (B,) [s]; NaN: not yet
        self.time = np.zeros(trials)  # in it, (B,) [s]

    def see(self, state: FleetState, radius: Array, distance: Array, gap: float) -> BoolArray:
        """Takes a state, a gap [s] after the last.

        Args:
            state: Of the robots.
            radius: Of each robot, (B, n) [m].
            distance: Of each pair, (B, pairs) [m].
            gap: What holds now has held for this long [s].

        Returns:
            Which trials are in the band, (B,).
        """
        shape, n = self._formation, radius.shape[-1]
        band = within(radius, shape.well_radius, shape.well_radius + shape.width, COMMON_TOLERANCE)
        if band.any():
            # Up to three robots are all neighbours of each other.
            sides = distance[band] if n <= 3 else neighbour_distances(state.position_w[band] - self._leader_w)
            band[band] = within(sides, shape.spacing, shape.spacing + shape.width, COMMON_TOLERANCE)
        self._hold(band, state.time, gap)
        return band

    def _hold(self, band: BoolArray, time: float, gap: float) -> None:
        """Counts how long the band has held at this time [s]."""
        if not band.any():
            self._since[:] = np.nan
            return
        self.time += np.where(band, gap, 0.0)
        self._since = np.where(band, np.where(np.isnan(self._since), time, self._since), np.nan)
        forms = np.isnan(self.formed) & (time - self._since >= HOLDING - 1e-9)
        self.formed = np.where(forms, self._since, self.formed)


def within(values: Array, low: float, high: float, tolerance: float) -> BoolArray:
    """Tells for each trial whether all its values are in a band widened by a tolerance, (B,)."""
    return np.all((values >= low - tolerance) & (values <= high + tolerance), axis=-1)
