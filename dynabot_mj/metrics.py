"""What a trial is judged by: settling, collision, completion.

The paper names these metrics in a sentence each; the readings below are ours, chosen to reproduce Table III. With r_i
the distance of robot i from the leader and T the duration:

settling    the mean of r_i over the robots, smoothed by its trailing 3 s mean, has settled at the first sample after
            the last one that is more than 1 % of the start distance (0.5 m) from the smoothed signal's mean over the
            last 10 s. A trial whose last sample is outside, or whose robots collided, has no settling time.
collision   two centres come nearer than the collision distance at any time. A rigid robot is larger than that, so the
            footprints (oriented rectangles, one test for both plants: the hull and the margin of 1 cm in which its
            contact begins) are judged beside; the centres alone decide settling and completion.
completion  at every 0.5 s of the last 10 s, all robots are within sigma of the corners of the regular polygon around
            the leader that fits them best in the least-squares sense, turned and assigned to the robots freely; its
            radius is the middle of what the wells' floors admit. With sigma = 0 (perfect information): all r_i within
            0.05 m of the floor h0 .. h0 + eps through the last 10 s.
common      all r_i within 1 m of the floor h0 .. h0 + eps, and the distances of robots that are neighbours around the
            leader within 1 m of d0 .. d0 + eps, through the last 10 s: one tolerance for all methods.

Runs shorter than 13 s have neither settling nor completion.
"""

import itertools
from dataclasses import dataclass

import numpy as np

from controllers.potential_field import polygon_circumradius
from dynabot_mj.arrays import Array, BoolArray
from dynabot_mj.plants import FleetState

SMOOTHING = 3.0  # trailing mean [s]
FINAL_WINDOW = 10.0  # the last part of the run, which settling and completion refer to [s]
COMPLETION_INTERVAL = 0.5  # [s]
ANNULUS_TOLERANCE = 0.05  # [m]
COMMON_TOLERANCE = 1.0  # [m]
SHORTEST_JUDGED = SMOOTHING + FINAL_WINDOW  # [s]


@dataclass(frozen=True, kw_only=True)
class Formation:
    """What the robots should form, and when they have collided."""

    well_radius: float  # h0 [m]
    spacing: float  # d0 [m]
    width: float  # epsilon [m]
    settling_band: float  # about the final mean distance, 1 % of the start distance [m]
    tolerance: float  # sigma of the method [m]; 0: the annulus criterion
    collision_distance: float  # between centres [m]
    length: float  # of a robot's footprint [m]
    breadth: float  # of a robot's footprint [m]


@dataclass(frozen=True, kw_only=True)
class Scores:
    """Outcome of each trial; NaN where a number is not defined."""

    settling: Array  # (B,) [s]
    settled: Array  # (B,) 1 or 0; NaN for trials too short or collided
    collision: BoolArray  # (B,) of centres
    collision_footprint: BoolArray  # (B,)
    completion: Array  # (B,) 1 or 0; NaN for trials too short
    completion_common: Array  # (B,) 1 or 0; NaN for trials too short
    top_speed: Array  # (B,) [m/s]
    closest: Array  # (B,) smallest distance between two centres [m]


def polygon_radius(formation: Formation, robots: int) -> float:
    """Returns the radius of the polygon that completion is measured against [m].

    It is the middle between h0 and the largest radius that both wells' floors admit, 3.289 m for the paper's three
    robots. Ours: with the literal radius h0 the robots, which rest anywhere on the floor, would complete far less
    often.
    """
    widest = polygon_circumradius(formation.spacing + formation.width, robots)
    return (formation.well_radius + min(formation.well_radius + formation.width, widest)) / 2.0


def settling_time(time: Array, radius: Array, band: float) -> Array:
    """Returns the 1 % settling time of the mean distance to the leader.

    Args:
        time: Sample times, rising, (K,) [s].
        radius: Mean distance of the robots to the leader, (K, B) [m].
        band: Largest distance from the final value of what has settled [m].

    Returns:
        (B,) [s]; NaN where the last sample is outside the band.
    """
    total = np.cumsum(radius, axis=0)
    first = np.searchsorted(time, time - SMOOTHING + 1e-9)
    before = np.where((first > 0)[:, None], total[np.maximum(first - 1, 0)], 0.0)
    smooth = (total - before) / (np.arange(len(time)) - first + 1)[:, None]
    final = smooth[time >= time[-1] - FINAL_WINDOW - 1e-9].mean(axis=0)
    outside = np.abs(smooth - final) > band
    # The sample after the last one outside; 0 where none is outside.
    settled_at = np.where(outside.any(axis=0), len(time) - np.argmax(outside[::-1], axis=0), 0)
    return np.where(outside[-1], np.nan, time[np.minimum(settled_at, len(time) - 1)])


def polygon_error(position_w: Array, radius: float) -> Array:
    """Returns the largest distance of a robot from its corner of the best-fitting regular polygon around the origin.

    With positions and corners as complex numbers z_i and R e^{i t} u^{k_i}, u = e^{2 pi i / n}, turning the polygon
    by t and giving corner k_i to robot i leaves the squared error sum |z_i|^2 + n R^2 - 2 R Re(e^{-i t} S), with S =
    sum z_i u^{-k_i}. So the best turn is t = arg S, and the best assignment the one with the largest |S|.

    Args:
        position_w: Relative to the leader, (..., n, 2) [m].
        radius: R of the polygon [m].

    Returns:
        (...) [m].
    """
    n = position_w.shape[-2]
    z = position_w[..., 0] + 1j * position_w[..., 1]
    unit = np.exp(2j * np.pi * np.arange(n) / n)
    best = np.zeros(z.shape[:-1], dtype=complex)
    corner = np.broadcast_to(unit, z.shape)
    # Turning permutes the corners cyclically, so robot 0 may keep corner 0.
    for rest in itertools.permutations(range(1, n)):
        assigned = unit[[0, *rest]]
        resultant = (z * assigned.conj()).sum(axis=-1)
        better = np.abs(resultant) > np.abs(best)
        best = np.where(better, resultant, best)
        corner = np.where(better[..., None], assigned, corner)
    turn = np.exp(1j * np.angle(best))
    return np.abs(z - radius * turn[..., None] * corner).max(axis=-1)


def footprints_touch(offset_w: Array, heading_a: Array, heading_b: Array, length: float, breadth: float) -> BoolArray:
    """Tells whether two equal oriented rectangles overlap, by the separating-axis theorem.

    Args:
        offset_w: Centre of b minus centre of a, (..., 2) [m].
        heading_a: (...,) [rad].
        heading_b: (...,) [rad].
        length: Along the heading [m].
        breadth: Across it [m].

    Returns:
        (...,).
    """
    cos_ab, sin_ab = np.abs(np.cos(heading_b - heading_a)), np.abs(np.sin(heading_b - heading_a))
    along = (length + length * cos_ab + breadth * sin_ab) / 2.0
    across = (breadth + length * sin_ab + breadth * cos_ab) / 2.0
    touch = np.ones(offset_w.shape[:-1], dtype=bool)
    for heading in (heading_a, heading_b):
        forward = np.cos(heading) * offset_w[..., 0] + np.sin(heading) * offset_w[..., 1]
        left = np.cos(heading) * offset_w[..., 1] - np.sin(heading) * offset_w[..., 0]
        touch &= (np.abs(forward) <= along) & (np.abs(left) <= across)
    return touch


class Scorer:
    """Judges the trials while they run, so that no history of the whole run is kept but the mean distance."""

    def __init__(self, formation: Formation, leader_w: Array, state: FleetState, duration: float) -> None:
        """Takes the start into account.

        Args:
            formation: What to judge against.
            leader_w: Position of the leader, (2,) [m].
            state: The state at time 0.
            duration: Of the run [s].
        """
        trials, robots = state.heading.shape
        self._formation, self._leader_w, self._duration = formation, leader_w, duration
        self._first, self._second = np.triu_indices(robots, 1)
        self._collision_footprint = np.zeros(trials, dtype=bool)
        self._annulus, self._common = np.ones(trials, dtype=bool), np.ones(trials, dtype=bool)
        self._top_speed = np.zeros(trials)
        self._closest = np.full(trials, np.inf)
        self._times: list[float] = []
        self._radii: list[Array] = []
        self._final: list[Array] = []
        self._final_times = (
            duration - FINAL_WINDOW + COMPLETION_INTERVAL * np.arange(round(FINAL_WINDOW / COMPLETION_INTERVAL) + 1)
        )
        self._previous = state
        self._see(state)

    def control(self, state: FleetState) -> None:
        """Takes a state at a control event, or the last one, for the settling time."""
        self._times.append(state.time)
        self._radii.append(self._distance(state).mean(axis=-1))

    def look(self, state: FleetState) -> None:
        """Takes a state between events, at most `plants.LOOK_PERIOD` after the one before."""
        self._see(state)
        while len(self._final) < len(self._final_times):
            time = self._final_times[len(self._final)]
            if time > state.time + 1e-9:
                break
            self._final.append(interpolate(self._previous, state, time) - self._leader_w)
        self._previous = state

    def scores(self, started: BoolArray | None = None) -> Scores:
        """Returns the outcome after the last look and the last control event.

        Args:
            started: Trials whose robots have all acted at some time, (B,); others rest where they are put, which is not
                settling. None: all.
        """
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
                error = polygon_error(positions, polygon_radius(self._formation, positions.shape[-2]))
                completed = np.all(error <= self._formation.tolerance, axis=0)
            completion = (completed & ~collision).astype(float)
            common = (self._common & ~collision).astype(float)
        return Scores(
            settling=settling,
            settled=np.where(collision | (not judged), np.nan, np.isfinite(settling).astype(float)),
            collision=collision,
            collision_footprint=self._collision_footprint,
            completion=completion,
            completion_common=common,
            top_speed=self._top_speed,
            closest=self._closest,
        )

    def _distance(self, state: FleetState) -> Array:
        offset = state.position_w - self._leader_w
        return np.hypot(offset[..., 0], offset[..., 1])

    def _see(self, state: FleetState) -> None:
        """Updates all that is a minimum, a maximum or "always" over the run."""
        velocity, position = state.velocity_w, state.position_w
        speed = np.hypot(velocity[..., 0], velocity[..., 1]).max(axis=-1)
        self._top_speed = np.maximum(self._top_speed, speed)
        offset = position[:, self._second] - position[:, self._first]
        distance = np.hypot(offset[..., 0], offset[..., 1])  # (B, pairs)
        self._closest = np.minimum(self._closest, distance.min(axis=-1))
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
            self._collision_footprint[trial[touch]] = True
        if state.time >= self._duration - FINAL_WINDOW - 1e-9:
            self._judge_rest(state)

    def _judge_rest(self, state: FleetState) -> None:
        """Updates the two criteria that hold through the last part of the run."""
        shape, radius = self._formation, self._distance(state)
        inner, outer = shape.well_radius, shape.well_radius + shape.width
        self._annulus &= _within(radius, inner, outer, ANNULUS_TOLERANCE)
        self._common &= _within(radius, inner, outer, COMMON_TOLERANCE)
        self._common &= _within(
            neighbour_distances(state.position_w - self._leader_w),
            shape.spacing,
            shape.spacing + shape.width,
            COMMON_TOLERANCE,
        )


def neighbour_distances(position_w: Array) -> Array:
    """Returns the distances of robots that follow each other in bearing around the leader.

    Args:
        position_w: Relative to the leader, (..., n, 2) [m].

    Returns:
        (..., n) [m]: the sides of the polygon that the robots span.
    """
    bearing = np.arctan2(position_w[..., 1], position_w[..., 0])
    order = np.argsort(bearing, axis=-1, kind="stable")
    around = np.take_along_axis(position_w, order[..., None], axis=-2)
    side = np.roll(around, -1, axis=-2) - around
    return np.hypot(side[..., 0], side[..., 1])


def interpolate(before: FleetState, after: FleetState, time: float) -> Array:
    """Returns the positions at a time between two states, linearly, (B, n, 2) [m]."""
    share = (time - before.time) / (after.time - before.time)
    return before.position_w + share * (after.position_w - before.position_w)


def _within(values: Array, low: float, high: float, tolerance: float) -> BoolArray:
    """Tells for each trial whether all its values are in a band widened by a tolerance, (B,)."""
    return np.all((values >= low - tolerance) & (values <= high + tolerance), axis=-1)
