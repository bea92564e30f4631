"""Random numbers: one stream per trial and purpose.

A trial's draws depend on the seed, its number and the purpose alone, never on how many trials share a chunk, on the
plant or on the estimator. So two cases with one seed share starts and radio draws (common random numbers), and adding
trials leaves the first ones unchanged. Whoever draws uses a fixed number of values per decision; rejection sampling
would desynchronise the streams.
"""

import enum
from collections.abc import Sequence

import numpy as np

from dynabot_mj.common.arrays import Array


class Purpose(enum.IntEnum):
    """What a stream is for; the numbers are part of every saved result's meaning and must not change."""

    START = 0
    HEADING = 1
    ESTIMATION_ERROR = 2
    LATENCY = 3
    LOSS = 4
    FRICTION = 5
    SWITCH_ON = 6  # of sensors
    IMU = 7
    GPS = 8
    SENSOR_FAULT = 9
    FITTED_POSITION = 10
    FITTED_VELOCITY = 11
    FITTED_HEADING = 12
    TILT = 13  # of the ground within a sampling period


def generators(seed: int, trials: Sequence[int], purpose: Purpose) -> list[np.random.Generator]:
    """Returns one generator per trial for a purpose."""
    return [
        np.random.Generator(np.random.PCG64DXSM(np.random.SeedSequence(seed, spawn_key=(int(purpose), trial))))
        for trial in trials
    ]


class Draws:
    """An endless sequence of arrays of random numbers, drawn from each trial's own stream in blocks."""

    def __init__(
        self,
        seed: int,
        trials: Sequence[int],
        purpose: Purpose,
        shape: tuple[int, ...],
        *,
        normal: bool = False,
        block: int = 256,
    ) -> None:
        """Prepares the streams.

        Args:
            seed: Seed of the study.
            trials: Numbers of the trials, length B.
            purpose: What the numbers are for.
            shape: Shape of one trial's array.
            normal: Standard normal numbers instead of uniform ones on [0, 1).
            block: Arrays drawn at once; it changes the speed, never the numbers.
        """
        self._generators = generators(seed, trials, purpose)
        self._normal = normal
        self._block = np.empty((block, len(trials), *shape))
        self._used = block

    def next(self) -> Array:
        """Returns the next array, (B, *shape); it is valid until the next call."""
        if self._used == len(self._block):
            self._refill()
        self._used += 1
        return self._block[self._used - 1]

    def _refill(self) -> None:
        length, _, *shape = self._block.shape
        for trial, generator in enumerate(self._generators):
            draw = generator.standard_normal if self._normal else generator.random
            self._block[:, trial] = draw((length, *shape))
        self._used = 0
