"""What a fault of a sensor costs each estimator on the circle, and how fast it is over; `troubles` has the faults.

Each run is compared with the same run without the fault: the same path, the same errors. Judged is the time from the
beginning of the fault to 10 s after its end, in which estimators should be back: the error of a run is back once it
lies within the band that 99 % of the unfaulted errors of that time keep to, or, since one in a hundred does not, within
a tenth of the band of the run's own unfaulted error; an estimator is back once 95 % of its runs are. A fault that lasts
is judged from when the robot begins to move. `crossings` judges the unfaulted runs.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from dynabot_mj.common import intervals
from dynabot_mj.common.arrays import Array, BoolArray, Progress
from dynabot_mj.common.intervals import Difference
from dynabot_mj.estimation.measurements import GpsFix, ImuSample, wrap
from dynabot_mj.experiments.estimators import checks, troubles
from dynabot_mj.experiments.estimators.crossings import Crossing, crossing
from dynabot_mj.experiments.estimators.troubles import BEGIN, LONGEST, Trouble
from dynabot_mj.perception import estimators
from dynabot_mj.sensing import replay
from dynabot_mj.sensing.ground_truth import GroundTruth
from dynabot_mj.sensing.options import SensorOptions
from dynabot_mj.sensing.replay import Samples

WITHIN = 10.0  # after the end of a fault, in which estimators should be back [s]
BAND = 0.99  # share of the unfaulted errors that are within the band
RETURNED = 0.95  # share of the runs that have to be back
_BELIEFS = ("position_w", "velocity_w", "heading", "position_covariance", "velocity_covariance_b", "heading_variance")
_DURATION = BEGIN + LONGEST + WITHIN  # [s]


@dataclass(frozen=True, kw_only=True)
class Cost:
    """What a fault costs an estimator."""

    fault: str
    estimator: str
    position_m: float  # mean of the runs' largest errors
    unfaulted_position_m: float  # the same without the fault
    worst_position_m: float  # of all runs
    excess_m: Difference  # of the largest errors over the unfaulted ones
    heading_deg: float
    unfaulted_heading_deg: float
    worst_heading_deg: float
    position_recovery_s: float | None  # of `RETURNED` of the runs, after the fault's end; None: not within `WITHIN`
    heading_recovery_s: float | None
    not_finite: int  # estimates
    restarts: int  # of all runs


@dataclass(frozen=True, kw_only=True)
class FaultsOutcome:
    """What was found."""

    seed: int
    runs: int
    costs: tuple[Cost, ...]
    crossings: tuple[Crossing, ...]


@dataclass(frozen=True, kw_only=True)
class _Errors:
    """Of R runs; positions and headings NaN while an estimator does not know."""

    position: Array  # (N, R) [m]
    heading: Array  # (N, R), not negative [rad]
    not_finite: BoolArray  # (N, R)
    restarts: Array  # (R,)

    def of(self, runs: slice) -> "_Errors":
        return _Errors(**{field.name: getattr(self, field.name)[..., runs] for field in fields(self)})


def run(
    seed: int, runs: int = 40, chosen: Sequence[Trouble] | None = None, progress: Progress = lambda share: None
) -> FaultsOutcome:
    """Lets everything go wrong.

    Args:
        seed: Of paths and errors.
        runs: Of each fault.
        chosen: What goes wrong; None: all of `troubles.every`.
        progress: Told the share of the work that is done.
    """
    chosen = troubles.every() if chosen is None else chosen
    unfaulted = checks.drive(SensorOptions(), runs, seed, _DURATION)
    drives = [unfaulted, *(checks.drive(one.options, runs, seed, _DURATION) for one in chosen)]
    samples = _side_by_side([one.samples for one in drives])
    costs: list[Cost] = []
    crossings: list[Crossing] = []
    for done, name in enumerate(estimators.NAMES):
        progress(done / len(estimators.NAMES))
        every = _errors(name, samples, unfaulted.truth)
        parts = [every.of(slice(index * runs, (index + 1) * runs)) for index in range(len(drives))]
        costs += [_cost(one, name, samples.time, part, parts[0]) for one, part in zip(chosen, parts[1:], strict=True)]
        crossings.append(crossing(name, unfaulted.truth, parts[0].position, parts[0].heading))
    ordered = sorted(costs, key=lambda one: [trouble.name for trouble in chosen].index(one.fault))
    return FaultsOutcome(seed=seed, runs=runs, costs=tuple(ordered), crossings=tuple(crossings))


def recovery(error: Array, unfaulted: Array, band: float, time: Array, end: float) -> float | None:
    """Returns after what time `RETURNED` of the runs are back [s]; None if fewer are at the end of the time.

    Args:
        error: Of the faulted runs, (N, R); NaN while it is not known.
        unfaulted: Of the same runs without the fault, (N, R).
        band: What unfaulted errors keep to.
        time: (N,) [s]
        end: Of the fault [s].
    """
    out = np.isnan(error) | ((error > band) & (error > unfaulted + 0.1 * band))
    out &= (time >= end)[:, None]
    # Of each run the first sample from which on it is never out again; len(time) where there is none.
    back = np.where(out.any(axis=0), len(time) - out[::-1].argmax(axis=0), 0)
    needed = int(np.sort(back)[math.ceil(RETURNED * len(back)) - 1])
    return None if needed == len(time) else max(float(time[needed]) - end, 0.0)


def _side_by_side(several: Sequence[Samples]) -> Samples:
    """Returns the runs of several records as those of one, so that an estimator follows all of them at once."""

    def joined(parts: Sequence[ImuSample] | Sequence[GpsFix]) -> dict[str, Any]:
        names = [field.name for field in fields(parts[0])]
        return {name: np.concatenate([getattr(part, name) for part in parts], axis=1) for name in names}

    return Samples(
        time=several[0].time,
        imu=ImuSample(**joined([one.imu for one in several])),
        fix=GpsFix(**joined([one.fix for one in several])),
    )


def _errors(name: str, samples: Samples, truth: GroundTruth) -> _Errors:
    """Runs an estimator over records of the same paths, one record beside the other."""
    count = samples.imu.magnetic_heading.shape[1]
    track = replay.follow(samples, estimators.build(name, (count,)))
    again = (1, count // truth.runs)
    away_w = track.position_w - np.tile(truth.position_w, (*again, 1))
    turned = wrap(track.heading - np.tile(truth.heading, again))
    parts = [getattr(track, name).reshape(*track.known.shape, -1) for name in _BELIEFS]
    everything = np.concatenate(parts, axis=-1).sum(axis=-1)
    return _Errors(
        position=np.where(track.known, np.hypot(away_w[..., 0], away_w[..., 1]), np.nan),
        heading=np.where(track.known, np.abs(turned), np.nan),
        not_finite=~np.isfinite(everything),
        restarts=track.restarts.astype(float),
    )


def _cost(trouble: Trouble, name: str, time: Array, faulted: _Errors, unfaulted: _Errors) -> Cost:
    until = math.inf if trouble.lasts else trouble.end + WITHIN
    judged = (time >= trouble.begin) & (time <= until) & np.isfinite(unfaulted.position).all(axis=1)
    largest, largest_unfaulted = (np.nanmax(one.position[judged], axis=0) for one in (faulted, unfaulted))
    turned, turned_unfaulted = (np.degrees(np.nanmax(one.heading[judged], axis=0)) for one in (faulted, unfaulted))

    def back(error: Array, reference: Array) -> float | None:
        return recovery(
            error[judged], reference[judged], float(np.quantile(reference[judged], BAND)), time[judged], trouble.end
        )

    return Cost(
        fault=trouble.name,
        estimator=name,
        position_m=float(largest.mean()),
        unfaulted_position_m=float(largest_unfaulted.mean()),
        worst_position_m=float(largest.max()),
        excess_m=intervals.paired_difference(largest, largest_unfaulted),
        heading_deg=float(turned.mean()),
        unfaulted_heading_deg=float(turned_unfaulted.mean()),
        worst_heading_deg=float(turned.max()),
        position_recovery_s=back(faulted.position, unfaulted.position),
        heading_recovery_s=back(faulted.heading, unfaulted.heading),
        not_finite=int(faulted.not_finite.sum()),
        restarts=int(faulted.restarts.sum()),
    )
