"""Judges trials while they run; what is judged, and why, is defined in `dynabot_mj.formation.metrics`."""

import numpy as np
import numpy.typing as npt

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.formation.geometry import footprints_touch, neighbour_distances, polygon_error
from dynabot_mj.formation.metrics import (
    ANNULUS_TOLERANCE,
    ARRIVAL_TOLERANCE,
    COMMON_TOLERANCE,
    COMPLETION_INTERVAL,
    FINAL_WINDOW,
    HOLDING,
    SHORTEST_JUDGED,
    UPRIGHT,
    Formation,
    Scores,
    polygon_radius,
    settling_time,
    trailing_mean,
)
from dynabot_mj.plants.plant import FleetState

_NO_PAIRS = (np.zeros(0, dtype=np.intp), np.zeros(0, dtype=np.intp))  # trials, and pairs in them


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
        self._contact, self._overturned, self._formed = never.copy(), never.copy(), never.copy()
        self._holds_since = never.copy()  # of the common band; NaN where it does not hold
        self._time_in_band = np.zeros(trials)
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
        self._times_in_band.append(self._time_in_band.copy())

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
            formation=self._formed,
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
        share = (self._time_in_band - before) / (self._duration - time[event])
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
        band = self._band(state, radius, distance)
        self._hold(band, state.time, gap)
        if state.time >= self._duration - FINAL_WINDOW - 1e-9:
            shape = self._formation
            self._annulus &= _within(radius, shape.well_radius, shape.well_radius + shape.width, ANNULUS_TOLERANCE)
            self._common &= band

    def _band(self, state: FleetState, radius: Array, distance: Array) -> BoolArray:
        """Tells which trials are in the common band.

        Args:
            state: Of the robots.
            radius: Of each robot, (B, n) [m].
            distance: Of each pair, (B, pairs) [m].

        Returns:
            (B,).
        """
        shape, n = self._formation, radius.shape[-1]
        band = _within(radius, shape.well_radius, shape.well_radius + shape.width, COMMON_TOLERANCE)
        if band.any():
            # Up to three robots are all neighbours of each other.
            sides = distance[band] if n <= 3 else neighbour_distances(state.position_w[band] - self._leader_w)
            band[band] = _within(sides, shape.spacing, shape.spacing + shape.width, COMMON_TOLERANCE)
        return band

    def _hold(self, band: BoolArray, time: float, gap: float) -> None:
        """Counts how long the band has held at this time [s]; what holds now has held for the gap [s] before."""
        if not band.any():
            self._holds_since[:] = np.nan
            return
        self._time_in_band += np.where(band, gap, 0.0)
        self._holds_since = np.where(band, np.where(np.isnan(self._holds_since), time, self._holds_since), np.nan)
        forms = np.isnan(self._formed) & (time - self._holds_since >= HOLDING - 1e-9)
        self._formed = np.where(forms, self._holds_since, self._formed)


def interpolate(before: FleetState, after: FleetState, time: float) -> Array:
    """Returns the positions at a time between two states, linearly, (B, n, 2) [m]; of one state, its own."""
    if after.time <= before.time:
        return before.position_w
    share = (time - before.time) / (after.time - before.time)
    return before.position_w + share * (after.position_w - before.position_w)


def _note(first: Array, trials: npt.NDArray[np.intp], time: float) -> None:
    """Writes down the first time that something happened in some trials."""
    first[trials] = np.where(np.isnan(first[trials]), time, first[trials])


def _within(values: Array, low: float, high: float, tolerance: float) -> BoolArray:
    """Tells for each trial whether all its values are in a band widened by a tolerance, (B,)."""
    return np.all((values >= low - tolerance) & (values <= high + tolerance), axis=-1)
