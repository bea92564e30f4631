"""What a trial is judged by: arrival, time to formation, collision, and the paper's settling and completion.

The paper names its metrics in a sentence each. With r_i the distance of robot i from the leader, r their mean, h0 ..
h0 + eps the floor of the leader's well, d0 .. d0 + eps that of the robots' wells, and T the duration:

arrival     the first control event at which the trailing 3 s mean of r (shorter at the start) is within 0.5 m of
            h0 .. h0 + eps, whatever happened before.
common      (band) all r_i within 1 m of h0 .. h0 + eps, and the distances of robots that are neighbours around the
            leader within 1 m of d0 .. d0 + eps: one tolerance for all methods.
formation   the start of the first 5 s throughout which the common band holds; one that starts in the run's last 5 s is
            not seen to hold.
in band     the share of the time from arrival to T in which it holds.
contact     the first time at which two footprints overlap: oriented rectangles, the hull and the margin of 1 cm in
            which its contact begins, one test for both plants.
overturned  the first time at which a body is tilted by more than 60 deg, from which it does not come back.

These are first-passage times: how long the run goes on changes them only from "not yet" to a time. Contacts and
overturned bodies decide outcomes: an event after one of them does not count as reached.

The paper's own, which depend on the length of the run or on a plant, and from which nothing is concluded:

settling    r, smoothed as above, has settled at the first sample after the last one that is more than 1 % of the start
            distance (0.5 m) from the smoothed signal's mean over the last 10 s. A trial whose last sample is outside,
            or whose centres collided, has no settling time. It is measured against the trial's own end: any late
            excursion resets it, and the longer the run, the likelier there is one.
collision   two centres come nearer than the collision distance at any time; a rigid robot is larger than that.
completion  at every 0.5 s of the last 10 s, all robots are within sigma of the corners of the regular polygon around
            the leader that fits them best (`dynabot_mj.formation.geometry`); its radius is the middle of what the
            wells' floors admit. With sigma = 0 (perfect information): all r_i within 0.05 m of h0 .. h0 + eps through
            the last 10 s.
            Centres that collided have not completed.

`completion_common` is the band's counterpart of completion, by which plants and methods are compared: the band holds
through the last 10 s, without a contact or an overturned body at any time.

Runs shorter than 13 s have neither settling nor completion.
"""

from dataclasses import dataclass

import numpy as np

from dynabot_mj.common.arrays import Array
from dynabot_mj.controllers.potential_field import polygon_circumradius
from dynabot_mj.formation.geometry import Fit

SMOOTHING = 3.0  # trailing mean [s]
FINAL_WINDOW = 10.0  # the last part of the run, which settling and completion refer to [s]
COMPLETION_INTERVAL = 0.5  # [s]
ANNULUS_TOLERANCE = 0.05  # [m]
COMMON_TOLERANCE = 1.0  # [m]
ARRIVAL_TOLERANCE = 0.5  # [m]
HOLDING = 5.0  # how long the band has to hold until a formation has formed [s]
SHORTEST_JUDGED = SMOOTHING + FINAL_WINDOW  # [s]
UPRIGHT = 0.5  # cosine of the largest tilt of a body: beyond 70 deg its centre of mass is outside its wheels


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
    fit: Fit = "least-squares"  # of the polygon that completion is measured against


def polygon_radius(formation: Formation, robots: int) -> float:
    """Returns the radius of the polygon that completion is measured against [m].

    It is the middle between h0 and the largest radius that both wells' floors admit, 3.289 m for the paper's three
    robots. Ours: with the literal radius h0 the robots, which rest anywhere on the floor, would complete far less
    often.
    """
    widest = polygon_circumradius(formation.spacing + formation.width, robots)
    return (formation.well_radius + min(formation.well_radius + formation.width, widest)) / 2.0


def trailing_mean(time: Array, values: Array) -> Array:
    """Returns the mean of the samples of the last 3 s at each of them, fewer at the start.

    Args:
        time: Sample times, rising, (K,) [s].
        values: (K, B).

    Returns:
        (K, B).
    """
    total = np.cumsum(values, axis=0)
    first = np.searchsorted(time, time - SMOOTHING + 1e-9)
    before = np.where((first > 0)[:, None], total[np.maximum(first - 1, 0)], 0.0)
    smooth: Array = (total - before) / (np.arange(len(time)) - first + 1)[:, None]
    return smooth


def settling_time(time: Array, radius: Array, band: float) -> Array:
    """Returns the 1 % settling time of the mean distance to the leader.

    Args:
        time: Sample times, rising, (K,) [s].
        radius: Mean distance of the robots to the leader, (K, B) [m].
        band: Largest distance from the final value of what has settled [m].

    Returns:
        (B,) [s]; NaN where the last sample is outside the band.
    """
    smooth = trailing_mean(time, radius)
    final = smooth[time >= time[-1] - FINAL_WINDOW - 1e-9].mean(axis=0)
    outside = np.abs(smooth - final) > band
    # The sample after the last one outside; 0 where none is outside.
    settled_at = np.where(outside.any(axis=0), len(time) - np.argmax(outside[::-1], axis=0), 0)
    return np.where(outside[-1], np.nan, time[np.minimum(settled_at, len(time) - 1)])


def restricted(event: Array, failure: Array, horizon: float) -> Array:
    """Returns the times of an event up to a horizon, whose mean is a restricted mean.

    Args:
        event: (B,) [s]; NaN: it did not happen.
        failure: First contact or overturned body, (B,) [s]; NaN: none.
        horizon: H [s].

    Returns:
        (B,) [s]: H where the event did not happen by then, or only after a failure.
    """
    reached = (event <= horizon) & ~(failure < event)
    return np.where(reached, event, horizon)
