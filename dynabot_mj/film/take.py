"""What a film shows, computed once from the recordings of a trial."""

from dataclasses import dataclass, replace

import numpy as np

from dynabot_mj.common.arrays import BoolArray, Progress
from dynabot_mj.film.shot import Shot
from dynabot_mj.study import scenario
from dynabot_mj.study.scenario import Scenario
from dynabot_mj.viewing import playback, recording
from dynabot_mj.viewing.recording import Recording
from dynabot_mj.viewing.stage import Snapshot

_MARKED = 1.0  # how long a collision is marked [s of film]


@dataclass(frozen=True, kw_only=True)
class Take:
    """One trial at the times of its frames, and at its end, K in all."""

    recording: Recording
    beside: Recording | None  # the same trial with point masses
    frames: int  # of the film, which ends before the trial's end, so that it is as long as the trial
    snapshots: list[Snapshot]  # K
    beside_snapshots: list[Snapshot]  # K, or none
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
    frames = max(1, int(np.ceil(scenario.duration(setup) / shot.interval - 1e-6)))
    frames = min(frames, len(own.time))
    return Take(
        recording=own,
        beside=other,
        frames=frames,
        snapshots=playback.snapshots(own),
        beside_snapshots=[] if other is None else playback.snapshots(other),
        collided=_collided(own, max(1, round(_MARKED * shot.rate))),
    )


def _collided(one: Recording, frames: int) -> BoolArray:
    """Returns who has collided within the latest frames, (K, n): hulls have overlapped, or centres were too near."""
    collided = one.overlapping | one.near
    found = collided.copy()
    for k in np.flatnonzero(collided.any(axis=1)):
        found[k : k + frames] |= collided[k]
    return found
