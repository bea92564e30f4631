"""What a film shows, computed once from the recordings of a trial."""

from dataclasses import dataclass, replace

import numpy as np

from dynabot_mj import playback, recording
from dynabot_mj.arrays import Array, BoolArray
from dynabot_mj.recording import Recording
from dynabot_mj.scenario import Scenario
from dynabot_mj.simulation import Progress
from dynabot_mj.stage import Snapshot
from dynabot_mj.video.shot import Shot

_MARKED = 1.0  # how long a collision is marked [s of film]


@dataclass(frozen=True, kw_only=True)
class Take:
    """One trial at the times of K frames."""

    recording: Recording
    beside: Recording | None  # the same trial with point masses
    frames: int  # K; the trial's end is not shown, so that the film is as long as the trial
    snapshots: list[Snapshot]  # at least K
    beside_snapshots: list[Snapshot]
    collided: BoolArray  # (K, n) who has just collided


def take(setup: Scenario, shot: Shot, beside: bool, progress: Progress = lambda share: None) -> Take:
    """Runs a trial, and the same one with point masses beside it.

    Args:
        setup: Of one trial of one case, see `scenario.one_trial`.
        shot: Tells how far the frames are apart.
        beside: Whether point masses are shown too.
        progress: Called now and then.
    """
    share = 0.5 if beside else 1.0
    own = recording.record(setup, shot.interval, lambda done: progress(share * done))
    other = None
    if beside:
        other = recording.record(
            replace(setup, plants=("particle",)), shot.interval, lambda done: progress(share + share * done)
        )
    frames = max(1, int(np.ceil(setup.duration / shot.interval - 1e-6)))
    frames = min(frames, len(own.time))
    return Take(
        recording=own,
        beside=other,
        frames=frames,
        snapshots=playback.snapshots(own),
        beside_snapshots=[] if other is None else playback.snapshots(other),
        collided=_collided(own, round(_MARKED * shot.rate))[:frames],
    )


def _collided(one: Recording, frames: int) -> BoolArray:
    """Returns who has collided within the latest frames, (K, n): hulls overlapped, or centres were too near."""
    found = one.overlapping.copy()
    n = found.shape[1]
    for k in np.flatnonzero(one.closest < one.setup.collision_distance):
        pair = np.unravel_index(np.argmin(distances(one.position_w[k])), (n, n))
        found[k, list(pair)] = True
    for k in np.flatnonzero(found.any(axis=1))[::-1]:
        found[k : k + frames] |= found[k]
    return found


def distances(position_w: Array) -> Array:
    """Returns the distances between robots, (n, n) [m], infinite from each to itself; positions (n, 2) [m]."""
    offset = position_w[:, None] - position_w[None]
    apart: Array = np.hypot(offset[..., 0], offset[..., 1])
    np.fill_diagonal(apart, np.inf)
    return apart
