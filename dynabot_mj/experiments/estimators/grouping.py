"""The decoupled EKF's sub-states, derived from the gains of the coupled one (Sec. III.B).

"State variables with the largest associated Kalman gain for a given measurement are grouped together." Gains have
units, so what is compared is the share of a state's variance that a measurement removes in the period of a fix. An
update takes K (H P) off the covariance; measurement j of a joint one takes

    K_ij (H P)_ji / P_ii

of the variance of state i, and these shares add up to that of the whole update. For a measurement on its own it is the
square of the normalised gain, K_ij sqrt(S_jj) / sqrt(P_ii). Bearings come with each sample and fixes every 0.2 s, so
a bearing's share counts as often as it comes in that time. The two velocities of a fix are one measurement, since body
axes turn through them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from dynabot_mj.common import tables
from dynabot_mj.common.arrays import Array
from dynabot_mj.estimation import motion
from dynabot_mj.estimation.coupled_ekf import CoupledEkf
from dynabot_mj.estimation.decoupled_ekf import GROUPS
from dynabot_mj.estimation.estimator import Estimator, Rows
from dynabot_mj.estimation.kalman import Update
from dynabot_mj.estimation.measurements import GpsFix
from dynabot_mj.estimation.parameters import DEFAULT, Parameters
from dynabot_mj.experiments.estimators import checks
from dynabot_mj.sensing import replay
from dynabot_mj.sensing.options import SensorOptions

MEASUREMENTS = ("position x", "position y", "velocity", "bearing")
_DURATION = 100.0  # [s]
_LAPS = 4  # the last ones, which are averaged over: gains turn with the robot

Groups = tuple[tuple[str, ...], ...]


@dataclass(frozen=True, kw_only=True)
class Grouping:
    """What was found."""

    seed: int
    runs: int
    # (10, 4) of each state's variance, removed by each of `MEASUREMENTS` in the period of a fix; states in the order of
    # `dynabot_mj.estimation.motion.NAMES`
    share: Array

    @property
    def groups(self) -> Groups:
        """The states that each measurement moves most."""
        return grouped(self.share)

    @property
    def margin(self) -> Array:
        """By how many times the largest share of each state exceeds the next one, (10,)."""
        ascending = np.sort(self.share, axis=-1)
        return ascending[:, -1] / np.maximum(ascending[:, -2], 1e-12)

    @property
    def agrees(self) -> bool:
        """Whether these are the decoupled EKF's sub-states."""
        return set(map(frozenset, self.groups)) == set(map(frozenset, GROUPS))


def run(seed: int, runs: int = 4, options: SensorOptions | None = None, parameters: Parameters = DEFAULT) -> Grouping:
    """Measures the coupled filter's steady gains on the circle.

    Args:
        seed: Of paths and errors.
        runs: Robots that are averaged over.
        options: Errors of the sensors; None: the default ones.
        parameters: The filter's.
    """
    options = options or SensorOptions()
    samples = checks.drive(options, runs, seed, _DURATION).samples
    ekf = _Tallied(runs, parameters)
    replay.follow(samples, Estimator(ekf, (runs,), parameters))
    steady = _LAPS * checks.LAP
    bearing = np.mean(ekf.bearing_shares[-round(steady / checks.PERIOD) :], axis=0)
    fix = np.mean(ekf.fix_shares[-round(steady / options.gps.period) :], axis=0)
    bearings = options.gps.period / checks.PERIOD
    share = np.column_stack([fix[:, :2], fix[:, 2:].sum(axis=-1), bearings * bearing[:, 0]])
    return Grouping(seed=seed, runs=runs, share=share)


def shares(covariance: Array, observation: Array, innovation_covariance: Array) -> Array:
    """Returns the shares of the variances that the components of a measurement remove, mean over robots, (s, m).

    Args:
        covariance: P before it, (M, s, s).
        observation: H, (M, m, s).
        innovation_covariance: S, (M, m, m).
    """
    crossed = np.swapaxes(observation @ covariance, -1, -2)  # P H^T
    removed = crossed @ np.linalg.inv(innovation_covariance) * crossed
    return (removed / np.diagonal(covariance, axis1=1, axis2=2)[..., None]).mean(axis=0)


def grouped(share: Array) -> Groups:
    """Returns the names of the states by the measurement that has the largest share, (10, 4), of each."""
    largest: npt.NDArray[np.intp] = share.argmax(axis=-1)
    found = (
        tuple(name for name, index in zip(motion.NAMES, largest, strict=True) if index == measurement)
        for measurement in range(len(MEASUREMENTS))
    )
    return tuple(names for names in found if names)


def document(found: Grouping) -> dict[str, Any]:
    """Returns the JSON document."""
    keys = [f"{name.replace(' ', '_')}_share" for name in MEASUREMENTS]
    return {
        "seed": found.seed,
        "runs": found.runs,
        "rows": [
            {"state": name, **dict(zip(keys, map(float, share), strict=True)), "margin": float(margin)}
            for name, share, margin in zip(motion.NAMES, found.share, found.margin, strict=True)
        ],
        "groups": found.groups,
        "decoupled_ekf": GROUPS,
        "agrees": found.agrees,
    }


def markdown(found: Grouping) -> str:
    """Returns the table."""
    rows = [
        [
            name,
            *(f"{100.0 * value:.3f}" for value in share),
            MEASUREMENTS[int(share.argmax())],
            f"{margin:.2f}" if margin < 100.0 else "> 100",
        ]
        for name, share, margin in zip(motion.NAMES, found.share, found.margin, strict=True)
    ]
    verdict = (
        "the sub-states of the decoupled EKF" if found.agrees else f"not those of the decoupled EKF, {_text(GROUPS)}"
    )
    lines = [
        f"# Grouping of the states by the coupled EKF's gains, seed {found.seed}",
        "",
        "Share of each state's variance [%] that each measurement removes per fix period, steady state on the circle,",
        f"mean over {_LAPS} laps of {found.runs} runs:",
        "",
        *tables.aligned(["state", *(f"{name} [%]" for name in MEASUREMENTS), "largest", "times the next"], rows),
        "",
        f"Groups: {_text(found.groups)}: {verdict}.",
    ]
    return "\n".join(lines) + "\n"


class _Tallied(CoupledEkf):
    """The filter, keeping count of what its measurements remove."""

    def __init__(self, count: int, parameters: Parameters) -> None:
        super().__init__(count, parameters)
        self.bearing_shares: list[Array] = []  # (10, 1) each
        self.fix_shares: list[Array] = []  # (10, 4) each

    def see_heading(self, rows: Rows, bearing: Array) -> Update:
        covariance = self.covariance[rows].copy()
        update = super().see_heading(rows, bearing)
        observation = np.zeros((len(covariance), 1, motion.STATES))
        observation[..., motion.HEADING] = 1.0
        self.bearing_shares.append(shares(covariance, observation, update.innovation_covariance))
        return update

    def see_fix(self, rows: Rows, fix: GpsFix, force_b: Array) -> tuple[Update]:
        covariance = self.covariance[rows].copy()
        _, observation = motion.fix_model(self.state[rows], force_b, fix.age)
        (update,) = super().see_fix(rows, fix, force_b)
        self.fix_shares.append(shares(covariance, observation, update.innovation_covariance))
        return (update,)


def _text(groups: Sequence[Sequence[str]]) -> str:
    return ", ".join("{" + ", ".join(names) + "}" for names in groups)
