"""Estimators run over a recorded log: what each believed, and, where the log has the truth, how wrong it was."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from dynabot_mj.common import tables
from dynabot_mj.common.arrays import Array, BoolArray, Progress, rms
from dynabot_mj.estimation.measurements import STALE, wrap
from dynabot_mj.estimation.parameters import DEFAULT, Parameters
from dynabot_mj.perception.estimators import NAMES, Implementation, build
from dynabot_mj.sensing import replay
from dynabot_mj.sensing.logs.log import Log
from dynabot_mj.sensing.replay import Track

# Of a track's CSV file; the sigmas of the velocity are along body axes, ahead and to the left.
TRACK_COLUMNS = (
    *("time_s", "x_m", "y_m", "vx_mps", "vy_mps", "heading_rad"),
    *("sigma_x_m", "sigma_y_m", "sigma_v_ahead_mps", "sigma_v_left_mps", "sigma_heading_rad"),
)
_NONE: Mapping[str, str] = {}


@dataclass(frozen=True, kw_only=True)
class EstimateRow:
    """One estimator on the log; None: not known."""

    estimator: str
    samples: int
    fixes: int
    fixes_rejected: int  # that had arrived while the estimator ran, and were not believed
    restarts: int  # times that its numbers broke down
    stale_share: float  # of the log's time, without a believed fix younger than 0.5 s
    final_position_m: tuple[float, float] | None
    largest_position_error_m: float | None
    rms_position_error_m: float | None
    rms_heading_error_rad: float | None


@dataclass(frozen=True, kw_only=True)
class Errors:
    """An estimate less the truth, NaN where either is missing."""

    position_w: Array  # (N, 2) [m]
    heading: Array  # (N,) wrapped [rad]


@dataclass(frozen=True, kw_only=True)
class Replay:
    """A log and what estimators made of it."""

    name: str  # of the log
    filters: Implementation
    parameters: Parameters
    log: Log
    tracks: dict[str, Track]  # arrays (N, 1, ...)
    rows: tuple[EstimateRow, ...]


def run(
    name: str,
    log: Log,
    estimators: Sequence[str] = NAMES,
    filters: Implementation = "batched",
    parameters: Parameters = DEFAULT,
    progress: Progress = lambda share: None,
    own: Mapping[str, str] = _NONE,
) -> Replay:
    """Runs estimators over a log, each from its first row.

    Args:
        name: Of the log.
        log: What the sensors said.
        estimators: Which ones.
        filters: Their implementation.
        parameters: What they assume of the sensors.
        progress: Told the share of the work that is done.
        own: Filters of the user's, by the names of their methods.
    """
    chosen = list(dict.fromkeys(estimators))
    samples, count = log.samples, len(log.time)
    tracks: dict[str, Track] = {}
    for estimator in chosen:
        done = len(tracks)
        tracks[estimator] = replay.follow(
            samples,
            build(estimator, (1,), parameters, filters, own.get(estimator)),
            lambda index, done=done: progress((done + (index + 1) / count) / len(chosen)),  # type: ignore[misc]
        )
    rows = tuple(_row(estimator, log, track) for estimator, track in tracks.items())
    return Replay(name=name, filters=filters, parameters=parameters, log=log, tracks=tracks, rows=rows)


def errors(log: Log, track: Track) -> Errors:
    """Returns what an estimator was wrong by."""
    known = track.known[:, 0]
    count = len(log.time)
    position_w = np.full((count, 2), np.nan) if log.position_w is None else track.position_w[:, 0] - log.position_w
    heading = np.full(count, np.nan) if log.heading is None else wrap(track.heading[:, 0] - log.heading)
    return Errors(position_w=np.where(known[:, None], position_w, np.nan), heading=np.where(known, heading, np.nan))


def document(found: Replay) -> dict[str, Any]:
    """Returns the JSON document."""
    time = found.log.time
    return {
        "log": found.name,
        "duration_s": float(time[-1] - time[0]),
        "filters": found.filters,
        "parameters": asdict(found.parameters),  # the [filter] table
        "rows": [asdict(row) for row in found.rows],
    }


def markdown(found: Replay) -> str:
    """Returns the summary as a table."""
    first, time = found.rows[0], found.log.time
    header = ["estimator", "rejected", "restarts", "stale [%]", "final position [m]"]
    body = [
        [
            row.estimator,
            str(row.fixes_rejected),
            str(row.restarts),
            f"{100.0 * row.stale_share:.1f}",
            "-" if row.final_position_m is None else "{:.2f}, {:.2f}".format(*row.final_position_m),
        ]
        for row in found.rows
    ]
    notes = [
        "Rejected: fixes that were not believed. Stale: share of the time without a believed fix younger than "
        f"{STALE:g} s,",
        "the time before the first fix included.",
    ]
    if any(truth is not None for truth in (found.log.position_w, found.log.heading)):
        header += ["largest error [m]", "RMS error [m]", "heading RMS [deg]"]
        for cells, row in zip(body, found.rows, strict=True):
            degrees = None if row.rms_heading_error_rad is None else float(np.degrees(row.rms_heading_error_rad))
            cells += [
                *(_number(value, 2) for value in (row.largest_position_error_m, row.rms_position_error_m)),
                _number(degrees, 1),
            ]
        notes.append("Errors are against the log's truth, from the first fix on.")
    lines = [
        f"# Replay of {found.name}",
        "",
        f"{first.samples} samples and {first.fixes} fixes in {time[-1] - time[0]:.1f} s:",
        "",
        *tables.aligned(header, body),
        "",
        *notes,
    ]
    return "\n".join(lines) + "\n"


def track_csv(track: Track) -> str:
    """Returns a track as CSV with the columns `TRACK_COLUMNS`; what is not known is empty."""
    values = np.concatenate(
        [
            track.position_w[:, 0],
            track.velocity_w[:, 0],
            wrap(track.heading),
            position_sigma(track),
            np.sqrt(np.diagonal(track.velocity_covariance_b[:, 0], axis1=1, axis2=2)),
            np.sqrt(track.heading_variance),
        ],
        axis=-1,
    )
    lines = [",".join(TRACK_COLUMNS)]
    for time, known, row in zip(track.time.tolist(), track.known[:, 0], values.tolist(), strict=True):
        lines.append(",".join([repr(time), *(repr(value) if known else "" for value in row)]))
    return "\n".join(lines) + "\n"


def position_sigma(track: Track) -> Array:
    """Returns the deviations of x and y, (N, 2) [m]."""
    return np.sqrt(np.diagonal(track.position_covariance[:, 0], axis1=1, axis2=2))


def _row(estimator: str, log: Log, track: Track) -> EstimateRow:
    wrong = errors(log, track)
    distance = np.linalg.norm(wrong.position_w, axis=-1)
    distance, turned = (values[np.isfinite(values)] for values in (distance, wrong.heading))
    known = track.known[:, 0]
    x, y = track.position_w[-1, 0].tolist()
    return EstimateRow(
        estimator=estimator,
        samples=len(log.time),
        fixes=int(np.isfinite(log.fix_time).sum()),
        fixes_rejected=int(_rejected(log, track).sum()),
        restarts=int(track.restarts[0]),
        stale_share=_stale_share(log, track),
        final_position_m=(x, y) if known[-1] else None,
        largest_position_error_m=float(distance.max()) if distance.size else None,
        rms_position_error_m=_rms(distance),
        rms_heading_error_rad=_rms(turned),
    )


def _rejected(log: Log, track: Track) -> BoolArray:
    """Tells which fixes were not believed, (N,): the age of the last believed one stays above theirs."""
    age = log.time - log.fix_time
    return np.isfinite(age) & track.known[:, 0] & (track.fix_age[:, 0] > age)


def _stale_share(log: Log, track: Track) -> float:
    """Returns the share of the time that the last believed fix is too old; it ages through the periods."""
    period = np.diff(log.time)
    stale = np.clip(track.fix_age[:-1, 0] + period - STALE, 0.0, period)
    return float(stale.sum() / period.sum())


def _rms(values: Array) -> float | None:
    return float(rms(values)) if values.size else None


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"
