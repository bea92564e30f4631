"""Judges trials while they run; what is judged, and why, is defined in `dynabot_mj.formation.metrics`."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.formation.band import Band, within
from dynabot_mj.formation.geometry import footprints_touch, polygon_error
from dynabot_mj.formation.metrics import (
    ANNULUS_TOLERANCE,
    ARRIVAL_TOLERANCE,
    COMPLETION_INTERVAL,
    FINAL_WINDOW,
    SHORTEST_JUDGED,
    UPRIGHT,
    Formation,
    polygon_radius,
    settling_time,
    trailing_mean,
)
from dynabot_mj.plants.plant import FleetState

_NO_PAIRS = (np.zeros(0, dtype=np.intp), np.zeros(0, dtype=np.intp))  # trials, and pairs in them


def _told(unit: str, meaning: str, *, always: bool = False) -> dict[str, Any]:
    """Returns what a Dataset states of a score.

    Args:
        unit: Of it; 1: a share, a count, or yes and no.
        meaning: Of it, and of NaN where it is not for a trial too short.
        always: Whether studies of every version have it; of others older ones tell nothing.
    """
    return {"unit": unit, "meaning": meaning, "always": always}


@dataclass(frozen=True, kw_only=True)
class Scores:
    """Outcome of each trial, each (B,); NaN where a number is not defined.

    Each becomes a variable of a study's Dataset by its own name.
    """

    arrival: Array = field(metadata=_told("s", "when the robots had come to the leader's well; NaN: not at all"))
    formation: Array = field(metadata=_told("s", "when the common band began to hold for 5 s; NaN: never"))
    in_band: Array = field(metadata=_told("1", "share of the time since arrival in the common band; NaN: not arrived"))
    contact: Array = field(metadata=_told("s", "when two footprints first overlapped; NaN: never"))
    overturned: Array = field(metadata=_told("s", "when a body was first on its side or back; NaN: never"))
    settling: Array = field(metadata=_told("s", "1 % settling time of the mean distance to the leader", always=True))
    settled: Array = field(metadata=_told("1", "1: settled, 0: not; NaN: collided or too short", always=True))
    collision: BoolArray = field(
        metadata=_told("1", "1: two centres came nearer than the collision distance", always=True)
    )
    collision_footprint: BoolArray = field(metadata=_told("1", "1: two footprints overlapped", always=True))
    completion: Array = field(metadata=_told("1", "1: formation within the method's own tolerance", always=True))
    completion_common: Array = field(metadata=_told("1", "1: formation within 1 m", always=True))
    top_speed: Array = field(metadata=_told("m/s", "highest speed of any robot", always=True))
    closest: Array = field(metadata=_told("m", "smallest distance between two centres", always=True))


class Scorer:
    """Keeps no history of the whole run but two numbers per event."""

    def __init__(self, formation: Formation, leader_w: Array, shape: tuple[int, ...], duration: float) -> None:
        """Has seen nothing yet.

        Args:
            formation: What to judge against.
            leader_w: Position of the leader, (2,) [m].
            shape: Trials and robots, (B, n).
            duration: Of the run [s].
        """
        trials, robots = shape
        self._formation, self._leader_w, self._duration = formation, leader_w, duration
        self._first, self._second = np.triu_indices(robots, 1)
        never = np.full(trials, np.nan)
        self._contact, self._overturned = never.copy(), never.copy()
        self._band = Band(formation, leader_w, trials)
        self._annulus, self._common = np.ones(trials, dtype=bool), np.ones(trials, dtype=bool)
        self._top_speed = np.zeros(trials)
        self._closest = np.full(trials, np.inf)
        self._times: list[float] = []
        self._radii: list[Array] = []
        self._times_in_band: list[Array] = []
        self._final: list[Array] = []
        self._final_times = (
            duration - FINAL_WINDOW + COMPLETION_INTERVAL * np.arange(round(FINAL_WINDOW / COMPLETION_INTERVAL) + 1)
        )
        self._previous: FleetState | None = None
        self.distance: Array = np.full((trials, len(self._first)), np.inf)  # of each pair in the latest state [m]
        self._touching = _NO_PAIRS

    def control(self, state: FleetState) -> None:
        """Takes a state at a control event, for arrival and settling."""
        self._times.append(state.time)
        self._radii.append(self._distance(state).mean(axis=-1))
        self._times_in_band.append(self._band.time.copy())

    def substep(self, state: FleetState) -> None:
        """Takes a state, the start first, at most `plants.plant.LONGEST_SUBSTEP` after the one before."""
        before = state if self._previous is None else self._previous
        self._see(state, state.time - before.time)
        while len(self._final) < len(self._final_times):
            time = self._final_times[len(self._final)]
            if time > state.time + 1e-9:
                break
            self._final.append(interpolate(before, state, time) - self._leader_w)
        self._previous = state

    @property
    def pairs(self) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
        """First and second robot of each pair, (pairs,)."""
        return self._first, self._second

    @property
    def overlapping(self) -> BoolArray:
        """Pairs whose footprints overlap in the latest state, (B, pairs)."""
        found = np.zeros(self.distance.shape, dtype=bool)
        found[self._touching] = True
        return found

    def scores(self, started: BoolArray | None = None) -> Scores:
        """Returns the outcome, after the last state, with which trials end as with a control event.

        Args:
            started: Trials whose robots have all acted at some time, (B,); others rest where they are put, which is not
                settling. None: all.
        """
        if self._previous is not None and self._times[-1:] != [self._previous.time]:
            self.control(self._previous)
        judged = self._duration >= SHORTEST_JUDGED
        collision = self._closest < self._formation.collision_distance
        undefined: Array = np.full(len(collision), np.nan)
        settling, completion, common = undefined, undefined, undefined
        if judged:
            settling = settling_time(np.array(self._times), np.array(self._radii), self._formation.settling_band)
            settling = np.where(collision | (False if started is None else ~started), np.nan, settling)
            completed: BoolArray = self._annulus
            if self._formation.tolerance > 0.0:
                positions = np.stack(self._final)
                radius = polygon_radius(self._formation, positions.shape[-2])
                error = polygon_error(positions, radius, self._formation.fit)
                completed = np.all(error <= self._formation.tolerance, axis=0)
            completion = (completed & ~collision).astype(float)
            common = (self._common & np.isnan(self._contact) & np.isnan(self._overturned)).astype(float)
        arrival, in_band = self._arrivals()
        return Scores(
            arrival=arrival,
            formation=self._band.formed,
            in_band=in_band,
            contact=self._contact,
            overturned=self._overturned,
            settling=settling,
            settled=np.where(collision | (not judged), np.nan, np.isfinite(settling).astype(float)),
            collision=collision,
            collision_footprint=np.isfinite(self._contact),
            completion=completion,
            completion_common=common,
            top_speed=self._top_speed,
            closest=self._closest,
        )

    def _arrivals(self) -> tuple[Array, Array]:
        """Returns when the robots arrived, (B,) [s], and the share of the time since then in the band, (B,)."""
        shape, time = self._formation, np.array(self._times)
        smooth = trailing_mean(time, np.array(self._radii))
        inner, outer = shape.well_radius - ARRIVAL_TOLERANCE, shape.well_radius + shape.width + ARRIVAL_TOLERANCE
        there = (smooth >= inner) & (smooth <= outer)
        there[time >= self._duration - 1e-9] = False  # the end is no event
        arrived, event = there.any(axis=0), there.argmax(axis=0)
        before = np.take_along_axis(np.array(self._times_in_band), event[None], axis=0)[0]
        share = (self._band.time - before) / (self._duration - time[event])
        # Sums of many gaps may exceed the time that they are of by their rounding.
        return np.where(arrived, time[event], np.nan), np.where(arrived, np.clip(share, 0.0, 1.0), np.nan)

    def _distance(self, state: FleetState) -> Array:
        offset = state.position_w - self._leader_w
        return np.hypot(offset[..., 0], offset[..., 1])

    def _see(self, state: FleetState, gap: float) -> None:
        """Updates all that is a minimum, a maximum, a first time or "always" over the run, a gap [s] after the last."""
        velocity, position = state.velocity_w, state.position_w
        speed = np.hypot(velocity[..., 0], velocity[..., 1]).max(axis=-1)
        self._top_speed = np.maximum(self._top_speed, speed)
        offset = position[:, self._second] - position[:, self._first]
        distance = np.hypot(offset[..., 0], offset[..., 1])  # (B, pairs)
        self._closest = np.minimum(self._closest, distance.min(axis=-1))
        self.distance, self._touching = distance, _NO_PAIRS
        near = distance < np.hypot(self._formation.length, self._formation.breadth)
        if near.any():
            trial, pair = np.nonzero(near)
            touch = footprints_touch(
                offset[near],
                state.heading[trial, self._first[pair]],
                state.heading[trial, self._second[pair]],
                self._formation.length,
                self._formation.breadth,
            )
            self._touching = trial[touch], pair[touch]
            _note(self._contact, trial[touch], state.time)
        if state.pose is not None:
            x, y = state.pose[..., 4], state.pose[..., 5]
            # The third component of the body's upward axis, from the quaternion w, x, y, z.
            fallen = (1.0 - 2.0 * (x * x + y * y) < UPRIGHT).any(axis=-1)
            if fallen.any():
                _note(self._overturned, np.nonzero(fallen)[0], state.time)
        radius = self._distance(state)
        band = self._band.see(state, radius, distance, gap)
        if state.time >= self._duration - FINAL_WINDOW - 1e-9:
            shape = self._formation
            self._annulus &= within(radius, shape.well_radius, shape.well_radius + shape.width, ANNULUS_TOLERANCE)
            self._common &= band


def interpolate(before: FleetState, after: FleetState, time: float) -> Array:
    """Returns the positions at a time between two states, linearly, (B, n, 2) [m]; of one state, its own."""
    if after.time <= before.time:
        return before.position_w
    share = (time - before.time) / (after.time - before.time)
    return before.position_w + share * (after.position_w - before.position_w)


def _note(first: Array, trials: npt.NDArray[np.intp], time: float) -> None:
    """Writes down the first time that something happened in some trials."""
    first[trials] = np.where(np.isnan(first[trials]), time, first[trials])
