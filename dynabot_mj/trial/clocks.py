"""When robots sample and act: one calendar of all events, in whole ticks of the processor's timer."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dynabot_mj.common.arrays import BoolArray


@dataclass(frozen=True, kw_only=True)
class Clocks:
    """When each robot samples and acts, in whole ticks of its processor's timer."""

    tick: float  # [s]
    sample_ticks: int  # T_s
    control_ticks: int  # T_c
    duration_ticks: int  # of the trial
    phase: npt.NDArray[np.int64]  # (n,) first event of each robot's clock; all zero where robots share one

    @property
    def sample_period(self) -> float:
        """T_s [s]."""
        return self.sample_ticks * self.tick

    @property
    def duration(self) -> float:
        """Of the trial [s]."""
        return self.duration_ticks * self.tick

    def events(self) -> Iterator[tuple[int, int]]:
        """Yields the merged calendar: each event's tick, and that of the next one or of the end."""
        due = {
            tick
            for phase in np.unique(self.phase).tolist()
            for period in (self.sample_ticks, self.control_ticks)
            for tick in range(phase, self.duration_ticks, period)
        }
        calendar = sorted(due | {0})
        yield from zip(calendar, [*calendar[1:], self.duration_ticks], strict=True)

    def due(self, tick: int, shape: tuple[int, ...]) -> tuple[BoolArray, BoolArray]:
        """Tells which robots sample at this tick, and whose control period begins.

        Args:
            tick: Of the timer.
            shape: Trials and robots, (B, n).

        Returns:
            Both (B, n).
        """
        sampling = self._due(tick, self.sample_ticks, shape)
        same = self.control_ticks == self.sample_ticks  # as they mostly are
        return sampling, sampling if same else self._due(tick, self.control_ticks, shape)

    def _due(self, tick: int, period: int, shape: tuple[int, ...]) -> BoolArray:
        since = tick - self.phase
        return np.broadcast_to((since >= 0) & (since % period == 0), shape)
