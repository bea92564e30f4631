"""What a fault of a sensor costs each estimator on the circle, and how fast it is over.

Each run is compared with the same run without the fault: the same path, the same errors. Judged is the time from the
beginning of the fault to 10 s after its end, in which estimators should be back: the error of a run is back once it
lies within the band that 99 % of the unfaulted errors of that time keep to, or, since one in a hundred does not, within
a tenth of the band of the run's own unfaulted error; an estimator is back once 95 % of its runs are. A fault that lasts
is judged from when the robot begins to move.

A frozen channel costs nothing while the vehicle's motion is as steady as on the circle, so the inertial channels freeze
a second time just before the robot begins to move.

Bearings jump at +-180 degrees, once in each lap. Whether innovations are wrapped shows in unfaulted runs: errors near
the jump beside those elsewhere.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from dynabot_mj import replay, statistics
from dynabot_mj.arrays import Array, BoolArray
from dynabot_mj.experiments import filter_checks, kinematic, tables
from dynabot_mj.experiments.filter_checks import PERIOD
from dynabot_mj.ground_truth import GroundTruth
from dynabot_mj.replay import Samples
from dynabot_mj.sensor_faults import Channel, Fault
from dynabot_mj.sensors import GpsErrors, ImuErrors, SensorOptions
from dynabot_mj.statistics import Difference
from estimation import build
from estimation.measurements import GpsFix, ImuSample, wrap

Progress = Callable[[float], None]

BEGIN = 30.0  # of a fault, once estimators have settled and robots drive [s]
WITHIN = 10.0  # after the end of a fault, in which estimators should be back [s]
BAND = 0.99  # share of the unfaulted errors that are within the band
RETURNED = 0.95  # share of the runs that have to be back
NEAR = math.radians(15.0)  # of +-180 degrees
_LONG, _SHORT, _DROPPING = 5.0, 2.0, 10.0  # how long faults last [s]
_DURATION = BEGIN + _DROPPING + WITHIN


@dataclass(frozen=True, kw_only=True)
class Trouble:
    """Something that goes wrong."""

    name: str
    options: SensorOptions
    begin: float = BEGIN  # from when on it is judged [s]
    end: float  # of the fault [s]
    lasts: bool = False  # to the end of the run; `end` is then from when on estimators should cope with it


@dataclass(frozen=True, kw_only=True)
class Cost:
    """What a fault costs an estimator."""

    fault: str
    estimator: build.Name
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
class Crossing:
    """RMS and largest errors of unfaulted runs where the bearing jumps, and elsewhere."""

    estimator: build.Name
    crossings: int
    near_heading_deg: float
    far_heading_deg: float
    near_largest_heading_deg: float
    far_largest_heading_deg: float
    near_position_m: float  # RMS per axis
    far_position_m: float


@dataclass(frozen=True, kw_only=True)
class FaultReport:
    """What was found."""

    seed: int
    runs: int
    costs: tuple[Cost, ...]
    crossings: tuple[Crossing, ...]


@dataclass(frozen=True, kw_only=True)
class _Errors:
    """Of some runs, NaN while an estimator does not know."""

    position: Array  # (N, R) [m]
    heading: Array  # (N, R), not negative [rad]
    not_finite: BoolArray  # (N, R)
    restarts: Array  # (R,)

    def of(self, runs: slice) -> "_Errors":
        return _Errors(
            position=self.position[:, runs],
            heading=self.heading[:, runs],
            not_finite=self.not_finite[:, runs],
            restarts=self.restarts[runs],
        )


def troubles() -> tuple[Trouble, ...]:
    """Returns what can go wrong."""

    def one(name: str, fault: Fault) -> Trouble:
        return Trouble(name=name, options=SensorOptions(faults=(fault,)), begin=fault.start, end=fault.end)

    def missing(channel: Channel, spacing: float) -> Trouble:
        """Makes the sample nearest to `BEGIN` of a channel not a number."""
        at = spacing * round(BEGIN / spacing)
        name = f"one NaN, {channel.replace('_', ' ').replace('gps', 'GPS')}"
        return one(name, Fault(kind="nan", channel=channel, start=at - 0.5 * spacing, end=at + 0.5 * spacing))

    turned, half_way = math.radians(170.0), kinematic.REST + 0.5 * kinematic.SPEED / kinematic.ACCELERATION
    long, fixes = BEGIN + _LONG, GpsErrors().period
    bias = ImuErrors(yaw_rate_bias=math.radians(2.0))
    return (
        one(f"GPS outage, {_LONG:g} s", Fault(kind="outage", start=BEGIN, end=long)),
        one(f"GPS jump of 15 m, {_SHORT:g} s", Fault(kind="jump", size=15.0, start=BEGIN, end=BEGIN + _SHORT)),
        one(f"GPS jump of 15 m, {_LONG:g} s", Fault(kind="jump", size=15.0, start=BEGIN, end=long)),
        one(
            f"30 % of fixes dropped, {_DROPPING:g} s",
            Fault(kind="dropped", size=0.3, start=BEGIN, end=BEGIN + _DROPPING),
        ),
        one(f"GPS velocity NaN, {_LONG:g} s", Fault(kind="nan", channel="gps_velocity", start=BEGIN, end=long)),
        missing("gps_position", fixes),
        missing("gps_velocity", fixes),
        missing("accelerometer", PERIOD),
        missing("gyro", PERIOD),
        missing("magnetometer", PERIOD),
        one(f"accelerometer frozen, {_LONG:g} s", Fault(kind="frozen", channel="accelerometer", start=BEGIN, end=long)),
        one(f"gyro frozen, {_LONG:g} s", Fault(kind="frozen", channel="gyro", start=BEGIN, end=long)),
        one(
            f"accelerometer frozen from rest, {_LONG:g} s",
            Fault(kind="frozen", channel="accelerometer", start=kinematic.REST, end=kinematic.REST + _LONG),
        ),
        one(
            f"gyro frozen from rest, {_LONG:g} s",
            Fault(kind="frozen", channel="gyro", start=kinematic.REST, end=kinematic.REST + _LONG),
        ),
        one(
            f"bearing off by 60°, {_LONG:g} s",
            Fault(kind="magnetic", size=math.radians(60.0), start=BEGIN, end=long),
        ),
        one("starts turned by 170°, ends at rest", Fault(kind="magnetic", size=turned, end=kinematic.REST - 0.5)),
        one("starts turned by 170°, ends in motion", Fault(kind="magnetic", size=turned, end=half_way)),
        Trouble(
            name="gyro bias of 2°/s",
            options=SensorOptions(imu=bias),
            begin=kinematic.REST,
            end=kinematic.REST,
            lasts=True,
        ),
    )


def run(
    seed: int, runs: int = 40, chosen: Sequence[Trouble] | None = None, progress: Progress = lambda share: None
) -> FaultReport:
    """Lets everything go wrong.

    Args:
        seed: Of paths and errors.
        runs: Of each fault.
        chosen: What goes wrong; None: all of `troubles`.
        progress: Told the share of the work that is done.
    """
    chosen = troubles() if chosen is None else chosen
    unfaulted = filter_checks.drive(SensorOptions(), runs, seed, _DURATION)
    drives = [unfaulted, *(filter_checks.drive(one.options, runs, seed, _DURATION) for one in chosen)]
    samples = _side_by_side([one.samples for one in drives])
    costs: list[Cost] = []
    crossings: list[Crossing] = []
    for done, name in enumerate(build.NAMES):
        progress(done / len(build.NAMES))
        every = _errors(name, samples, unfaulted.truth)
        parts = [every.of(slice(index * runs, (index + 1) * runs)) for index in range(len(drives))]
        costs += [_cost(one, name, samples.time, part, parts[0]) for one, part in zip(chosen, parts[1:], strict=True)]
        crossings.append(_crossing(name, unfaulted.truth, parts[0]))
    ordered = sorted(costs, key=lambda one: [trouble.name for trouble in chosen].index(one.fault))
    return FaultReport(seed=seed, runs=runs, costs=tuple(ordered), crossings=tuple(crossings))


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


def document(report: FaultReport) -> dict[str, Any]:
    """Returns the JSON document."""
    return {
        "seed": report.seed,
        "runs": report.runs,
        "faults": [asdict(one) for one in report.costs],
        "crossings": [asdict(one) for one in report.crossings],
    }


def markdown(report: FaultReport) -> str:
    """Returns the tables."""
    costs = [
        [
            one.fault,
            one.estimator,
            f"{one.position_m:.2f}",
            f"{one.worst_position_m:.2f}",
            _difference(one.excess_m),
            f"{one.heading_deg:.1f}",
            f"{one.heading_deg - one.unfaulted_heading_deg:.1f}",
            _seconds(one.position_recovery_s),
            _seconds(one.heading_recovery_s),
            f"{one.not_finite}",
            f"{one.restarts}",
        ]
        for one in report.costs
    ]
    crossings = [
        [
            one.estimator,
            f"{one.crossings}",
            f"{one.near_heading_deg:.2f}, {one.far_heading_deg:.2f}",
            f"{one.near_largest_heading_deg:.1f}, {one.far_largest_heading_deg:.1f}",
            f"{one.near_position_m:.2f}, {one.far_position_m:.2f}",
        ]
        for one in report.crossings
    ]
    lines = [
        f"# Faults of sensors, {report.runs} runs on the circle, seed {report.seed}",
        "",
        f"From the beginning of the fault to {WITHIN:g} s after its end: the largest errors of a run, their mean over",
        "the runs, and by how much that exceeds the same runs without the fault (95 % bootstrap); after how long",
        f"{100.0 * RETURNED:g} % of the runs are back in the band of {100.0 * BAND:g} % of the unfaulted errors.",
        "",
        *tables.aligned(
            [
                "fault",
                "estimator",
                "position [m]",
                "worst run",
                "excess [m]",
                "heading [deg]",
                "excess [deg]",
                "position back [s]",
                "heading back [s]",
                "not finite",
                "restarts",
            ],
            costs,
        ),
        "",
        f"Unfaulted errors within {math.degrees(NEAR):g} degrees of where the bearing jumps by 360, and elsewhere:",
        "",
        *tables.aligned(
            ["estimator", "crossings", "heading RMS [deg]", "largest [deg]", "position RMS [m]"], crossings
        ),
    ]
    return "\n".join(lines) + "\n"


def _side_by_side(several: Sequence[Samples]) -> Samples:
    """Returns the runs of several records as those of one, so that an estimator follows all of them at once."""

    def joined(part: Callable[[Samples], Array]) -> Array:
        return np.concatenate([part(one) for one in several], axis=1)

    return Samples(
        time=several[0].time,
        imu=ImuSample(
            period=joined(lambda one: one.imu.period),
            specific_force_b=joined(lambda one: one.imu.specific_force_b),
            yaw_rate=joined(lambda one: one.imu.yaw_rate),
            bearing=joined(lambda one: one.imu.bearing),
        ),
        fix=GpsFix(
            received=np.concatenate([one.fix.received for one in several], axis=1),
            position_w=joined(lambda one: one.fix.position_w),
            velocity_w=joined(lambda one: one.fix.velocity_w),
            age=joined(lambda one: one.fix.age),
        ),
    )


def _errors(name: build.Name, samples: Samples, truth: GroundTruth) -> _Errors:
    """Runs an estimator over records of the same paths, one record beside the other."""
    count = samples.imu.bearing.shape[1]
    track = replay.follow(samples, build.build(name, (count,)))
    again = (1, count // truth.runs)
    away_w = track.position_w - np.tile(truth.position_w, (*again, 1))
    turned = wrap(track.heading - np.tile(truth.heading, again))
    beliefs = (
        track.position_w,
        track.velocity_w,
        track.heading[..., None],
        track.position_covariance.reshape(*track.known.shape, 4),
        track.velocity_covariance_b.reshape(*track.known.shape, 4),
        track.heading_variance[..., None],
    )
    all_of_it: Array = np.concatenate(beliefs, axis=-1).sum(axis=-1)
    return _Errors(
        position=np.where(track.known, np.hypot(away_w[..., 0], away_w[..., 1]), np.nan),
        heading=np.where(track.known, np.abs(turned), np.nan),
        not_finite=~np.isfinite(all_of_it),
        restarts=track.restarts.astype(float),
    )


def _cost(trouble: Trouble, name: build.Name, time: Array, faulted: _Errors, unfaulted: _Errors) -> Cost:
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
        excess_m=statistics.paired_difference(largest, largest_unfaulted),
        heading_deg=float(turned.mean()),
        unfaulted_heading_deg=float(turned_unfaulted.mean()),
        worst_heading_deg=float(turned.max()),
        position_recovery_s=back(faulted.position, unfaulted.position),
        heading_recovery_s=back(faulted.heading, unfaulted.heading),
        not_finite=int(faulted.not_finite.sum()),
        restarts=int(faulted.restarts.sum()),
    )


def _crossing(name: build.Name, truth: GroundTruth, unfaulted: _Errors) -> Crossing:
    settled = truth.time >= 0.5 * BEGIN
    around = wrap(truth.heading[settled] - math.pi)
    near = np.abs(around) < NEAR
    heading, position = np.degrees(unfaulted.heading[settled]), unfaulted.position[settled]

    def rms(values: Array) -> float:
        return float(np.sqrt((values**2).mean()))

    return Crossing(
        estimator=name,
        crossings=int(((around[:-1] < 0.0) & (around[1:] >= 0.0)).sum()),
        near_heading_deg=rms(heading[near]),
        far_heading_deg=rms(heading[~near]),
        near_largest_heading_deg=float(heading[near].max()),
        far_largest_heading_deg=float(heading[~near].max()),
        near_position_m=rms(position[near]) / math.sqrt(2.0),
        far_position_m=rms(position[~near]) / math.sqrt(2.0),
    )


def _seconds(value: float | None) -> str:
    return f"> {WITHIN:g}" if value is None else f"{value:.1f}"


def _difference(value: Difference) -> str:
    if value.difference is None or value.low is None or value.high is None:
        return "-"
    return f"{value.difference:.2f} [{value.low:.2f}, {value.high:.2f}]"
