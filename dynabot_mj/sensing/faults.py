"""What can go wrong with a sensor for a while, by name and time window.

outage     no fixes                                     dropped    samples of a channel are missing, each with a chance
jump       the GPS position moves toward +x             frozen     a channel repeats what it said before
magnetic   the bearing is turned                        nan        a channel is not a number
"""

import math
from collections.abc import Sequence
from typing import Annotated, Literal

import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.common.streams import Draws, Purpose
from dynabot_mj.common.validation import LARGEST, STRICT

FaultKind = Literal["outage", "jump", "magnetic", "dropped", "frozen", "nan"]
Channel = Literal["gps_position", "gps_velocity", "accelerometer", "gyro", "magnetometer"]


@dataclass(frozen=True, kw_only=True, config=STRICT)
class Fault:
    """One fault."""

    kind: FaultKind
    channel: Channel | None = None  # of dropped, frozen and nan; the other kinds have one of their own
    start: float = 0.0  # [s]
    end: float = math.inf  # [s]
    size: float | None = None  # of a jump [m], of the bearing's turn [rad]; share of the samples that are dropped
    robots: tuple[Annotated[int, Field(ge=0)], ...] = ()  # that have it, counted from 0; (): all


def check(faults: Sequence[Fault], robots: int) -> None:
    """Checks that faults act, and on robots that there are.

    Args:
        faults: What goes wrong.
        robots: Number of robots n.

    Raises:
        InputError: With the first one that does not.
    """
    for fault in faults:
        if not fault.start < fault.end:
            raise InputError(f"sensors.faults: a fault from {fault.start:g} to {fault.end:g} s given, it never acts")
        _check_parts(fault)
        if fault.robots and max(fault.robots) >= robots:
            raise InputError(f"sensors.faults: robot {max(fault.robots)} given, there are the robots 0 to {robots - 1}")


def _check_parts(fault: Fault) -> None:
    """Checks that a fault has the parts that its kind needs, and no others."""
    needs = {
        "channel": fault.kind in ("dropped", "frozen", "nan"),
        "size": fault.kind in ("jump", "magnetic", "dropped"),
    }
    for name, needed in needs.items():
        given = getattr(fault, name)
        if needed != (given is not None):
            told = f"{name} = {given}" if given is not None else f"no {name}"
            raise InputError(
                f"sensors.faults: {told} given with {fault.kind}, which needs {'one' if needed else 'none'}"
            )
    if fault.size is not None:
        share = fault.kind == "dropped"
        if not (0.0 < fault.size <= 1.0 if share else 0.0 < abs(fault.size) <= LARGEST):
            allowed = "above 0 and at most 1" if share else f"not 0, and at most {LARGEST:g}"
            raise InputError(f"sensors.faults: size = {fault.size:g} given with {fault.kind}, it must be {allowed}")


class Faults:
    """The faults of all robots of some trials."""

    def __init__(self, faults: Sequence[Fault], seed: int, trials: Sequence[int], robots: int) -> None:
        """Starts with what has been heard of no channel.

        Args:
            faults: Of each trial.
            seed: Seed of the study.
            trials: Numbers of the trials, length B.
            robots: Number of robots n.
        """
        self._faults = tuple(faults)
        self._chance = Draws(seed, trials, Purpose.SENSOR_FAULT, (robots,))
        self._has = [np.isin(np.arange(robots), fault.robots) | (not fault.robots) for fault in self._faults]
        self._said: dict[int, Array] = {}  # by a channel that may freeze

    def fixes(self, position_w: Array, velocity_w: Array, time: float) -> tuple[Array, Array, BoolArray]:
        """Returns what becomes of fixes, (B, n, 2) each [m], [m/s], and which are received, (B, n)."""
        received = np.ones(position_w.shape[:2], dtype=bool)
        for index, fault in enumerate(self._faults):
            if fault.kind == "outage":
                received &= ~self._acts(index, time)
            elif fault.kind == "jump":
                position_w = position_w + np.where(self._acts(index, time)[:, None], [fault.size or 0.0, 0.0], 0.0)
        return self.samples("gps_position", position_w, time), self.samples("gps_velocity", velocity_w, time), received

    def samples(self, channel: Channel, value: Array, time: float) -> Array:
        """Returns what becomes of the samples of a channel, (B, n, ...)."""
        for index, fault in enumerate(self._faults):
            acts = self._acts(index, time)
            if fault.kind == "magnetic" and channel == "magnetometer":
                value = value + np.where(acts, fault.size or 0.0, 0.0)
            elif fault.kind in ("dropped", "frozen", "nan") and fault.channel == channel:
                value = self._afflicted(index, value, acts)
        return value

    def _afflicted(self, index: int, value: Array, acts: BoolArray) -> Array:
        has = np.broadcast_to(acts, value.shape[:2])
        other: Array | float = np.nan
        if self._faults[index].kind == "dropped":
            has = has & (self._chance.next() < (self._faults[index].size or 0.0))
        if self._faults[index].kind == "frozen":
            other = self._said.get(index, value)
        value = np.where(has.reshape(*has.shape, *[1] * (value.ndim - 2)), other, value)
        if self._faults[index].kind == "frozen":
            self._said[index] = value
        return value

    def _acts(self, index: int, time: float) -> BoolArray:
        """Tells which robots have a fault now, (n,)."""
        fault = self._faults[index]
        return self._has[index] & (fault.start <= time < fault.end)
