"""Whether the filters' covariances are those of their errors, judged by the bounds of `consistency_bounds`.

Three sets of sensors: with just the errors that the filters assume, and no latency; the same with the receiver's
latency, over which filters reach back with the motion of now; and the default ones, whose errors are coloured.
"""

import math
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from dynabot_mj.common.arrays import Array, rms
from dynabot_mj.estimation import motion
from dynabot_mj.estimation.coupled_ekf import CoupledEkf
from dynabot_mj.estimation.decoupled_ekf import GROUPS, DecoupledEkf
from dynabot_mj.estimation.estimator import Estimator
from dynabot_mj.estimation.kalman import Update
from dynabot_mj.estimation.parameters import DEFAULT, Parameters
from dynabot_mj.experiments.estimators import checks, consistency_bounds, scores
from dynabot_mj.experiments.estimators.checks import Drives
from dynabot_mj.experiments.estimators.consistency_bounds import Kind, Squares, Whiteness
from dynabot_mj.sensing import replay
from dynabot_mj.sensing.options import GpsErrors, SensorOptions, matched

EkfName = Literal["coupled", "decoupled"]
EKFS: tuple[EkfName, ...] = get_args(EkfName)

SETTLED = 15.0  # from when errors are judged [s]
DURATION = 100.0  # [s]

# States whose errors are judged together.
PARTS = {"all states": motion.NAMES} | {" ".join(names): names for names in (*GROUPS, ("phi",))}
# What the estimators' updates by a fix are of.
_FIXES = {"coupled": ("fix",), "decoupled": ("fix velocity", "fix X", "fix Y")}

# What can be matched: a walk has no stationary state to start from, and a circle is driven exactly.
MATCHED = replace(DEFAULT, yaw_rate_bias_walk=0.0, position_density=1e-3)


@dataclass(frozen=True, kw_only=True)
class Case:
    """One filter with one set of sensors."""

    sensors: str
    estimator: EkfName
    squares: tuple[Squares, ...]
    whiteness: tuple[Whiteness, ...]
    position_m: float  # RMS error per axis
    heading_deg: float  # RMS error

    def too_small(self, kind: Kind) -> tuple[str, ...]:
        """Returns the states whose covariance is too small, or of which innovations the filter could tell it by."""
        return tuple(one.of for one in self.squares if one.kind == kind and one.verdict == "too small")

    @property
    def coloured(self) -> tuple[str, ...]:
        """The innovations that are not white."""
        return tuple(one.of for one in self.whiteness if not one.white)


@dataclass(frozen=True, kw_only=True)
class ConsistencyOutcome:
    """What was found."""

    seed: int
    runs: int
    cases: tuple[Case, ...]


def sensors() -> dict[str, tuple[SensorOptions, Parameters]]:
    """Returns the sets of sensors, and what the filters assume of them, by name."""
    delayed = matched(MATCHED)
    prompt = replace(delayed, gps=replace(delayed.gps, latency=0.0))
    return {
        "matched, no latency": (prompt, MATCHED),
        f"matched, {GpsErrors().latency:g} s": (delayed, MATCHED),
        "default": (SensorOptions(), DEFAULT),
    }


def run(seed: int, runs: int = 64) -> ConsistencyOutcome:
    """Examines both filters with all sets of sensors.

    Args:
        seed: Of paths and errors.
        runs: R.
    """
    cases: list[Case] = []
    for name, (options, parameters) in sensors().items():
        drives = checks.drive(options, runs, seed, DURATION)
        cases += [examine(name, estimator, drives, parameters) for estimator in EKFS]
    return ConsistencyOutcome(seed=seed, runs=runs, cases=tuple(cases))


def examine(of: str, name: EkfName, drives: Drives, parameters: Parameters) -> Case:
    """Runs a filter and judges what only the simulation can.

    Args:
        of: Name of the sensors.
        name: Of the filter.
        drives: Samples and what was true.
        parameters: The filter's.
    """
    error, squares, updates = _watched(name, drives, parameters)
    innovations = {one: np.array([consistency_bounds.unit(update) for update in updates[one]]) for one in updates}
    judged = [consistency_bounds.nees(part, np.array(squares[part]), len(PARTS[part])) for part in PARTS]
    for one, innovation in innovations.items():
        squared = np.array([update.squared for update in updates[one]])
        judged.append(consistency_bounds.nis(one, squared, innovation.shape[-1]))
    return Case(
        sensors=of,
        estimator=name,
        squares=tuple(judged),
        whiteness=tuple(consistency_bounds.whiteness(one, innovation) for one, innovation in innovations.items()),
        position_m=float(rms(error[..., motion.POSITION])),
        heading_deg=math.degrees(rms(error[..., motion.HEADING])),
    )


def _watched(
    name: EkfName, drives: Drives, parameters: Parameters
) -> tuple[Array, dict[str, list[Array]], dict[str, list[Update]]]:
    """Returns a settled filter's errors, (N, R, 10), their NEES by part, (R,) each, and its updates by measurement."""
    runs = drives.truth.runs
    ekf = CoupledEkf(runs, parameters) if name == "coupled" else DecoupledEkf(runs, parameters)
    estimator = Estimator(ekf, (runs,), parameters)
    truth = scores.ten_states(drives.truth, drives.samples)
    errors: list[Array] = []
    squares: dict[str, list[Array]] = {part: [] for part in PARTS}
    updates: dict[str, list[Update]] = {one: [] for one in ("bearing", *_FIXES[name])}

    def collect(index: int) -> None:
        if drives.samples.time[index] < SETTLED:
            return
        state, covariance = ekf.moments()
        error = scores.less(state, truth[index])
        errors.append(error)
        for part, states in PARTS.items():
            chosen = [motion.NAMES.index(one) for one in states]
            squares[part].append(scores.nees(error[:, chosen], covariance[:, chosen][:, :, chosen]))
        assert estimator.heading_update is not None
        updates["bearing"].append(estimator.heading_update[1])
        for one, update in zip(_FIXES[name], estimator.fix_updates[1], strict=False):
            updates[one].append(update)

    replay.follow(drives.samples, estimator, collect)
    return np.array(errors), squares, updates
