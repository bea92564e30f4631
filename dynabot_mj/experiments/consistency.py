"""Whether the filters' covariances are those of their errors: NEES, NIS and whiteness of the innovations.

NEES  e^T P^-1 e of the errors e of some states; in the mean their number, if the covariance P is right.
NIS   nu^T S^-1 nu of an innovation; in the mean the number of its components.

Both are chi-square distributed in a consistent filter, so that their mean over R runs at one time lies in the 99 %
bounds chi2(R k) / R in 99 % of the times. Innovations of an optimal filter are white, so the mean of NIS over all
measurements has the same bounds with the number of all of them. Estimation errors are not: the mean of NEES over runs
and times is judged by the spread between the runs (Student's t). Whiteness: autocorrelations of the innovations, each
made unit by the Cholesky factor of S, at lags 1 to 10; of n of them, each lies within 2.58 / sqrt(n) in 99 % of the
cases, and the largest of all of them within Bonferroni's bound.

Three sets of sensors: with just the errors that the filters assume, and no latency; the same with the receiver's
latency, over which filters reach back with the motion of now; and the default ones, whose errors are coloured.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal, get_args

import numpy as np
from scipy import stats

from dynabot_mj import replay
from dynabot_mj.arrays import Array
from dynabot_mj.experiments import filter_checks, tables
from dynabot_mj.experiments.estimation_scores import ten_states
from dynabot_mj.experiments.filter_checks import Drives
from dynabot_mj.sensors import GpsErrors, SensorOptions, matched
from estimation import motion
from estimation.coupled_ekf import CoupledEkf
from estimation.decoupled_ekf import GROUPS, DecoupledEkf
from estimation.estimator import Estimator
from estimation.kalman import Update
from estimation.measurements import wrap
from estimation.parameters import DEFAULT, Parameters

EkfName = Literal["coupled", "decoupled"]
EKFS: tuple[EkfName, ...] = get_args(EkfName)

CONFIDENCE = 0.99
LAGS = 10
SETTLED = 15.0  # from when errors are judged [s]
_DURATION = 100.0  # [s]

# States whose errors are judged together.
PARTS = (motion.NAMES, *GROUPS, ("phi",))
# What the estimators' updates by a fix are of.
_FIXES = {"coupled": ("fix",), "decoupled": ("fix velocity", "fix X", "fix Y")}

# What can be matched: a walk has no stationary state to start from, and a circle is driven exactly.
MATCHED = replace(DEFAULT, yaw_rate_bias_walk=0.0, position_density=1e-3)


@dataclass(frozen=True, kw_only=True)
class Squares:
    """Normalised squares of errors or innovations."""

    sensors: str
    estimator: EkfName
    kind: Literal["NEES", "NIS"]
    of: str
    components: int
    mean: float  # over runs and times
    low: float  # bounds of that
    high: float
    inside: float  # share of the times at which the mean over runs is inside its bounds

    @property
    def verdict(self) -> str:
        """What the mean says of the covariance."""
        if self.mean > self.high:
            return "too small"
        return "too large" if self.mean < self.low else "consistent"


@dataclass(frozen=True, kw_only=True)
class Whiteness:
    """Autocorrelations of innovations at lags 1 to `LAGS`."""

    sensors: str
    estimator: EkfName
    of: str
    components: int
    samples: int
    largest: float  # of all lags and components, with its sign
    lag: int  # where that is
    bound: float  # of one
    outside: int  # of LAGS * components
    bound_of_all: float

    @property
    def white(self) -> bool:
        """Whether the largest is within the bound of all."""
        return abs(self.largest) <= self.bound_of_all


@dataclass(frozen=True, kw_only=True)
class Errors:
    """How large the errors are, beside how consistent."""

    sensors: str
    estimator: EkfName
    position_m: float  # RMS per axis
    heading_deg: float  # RMS


@dataclass(frozen=True, kw_only=True)
class Deceived:
    """Whose covariance is too small, and whether the filter could tell without knowing the truth."""

    sensors: str
    estimator: EkfName
    states: tuple[str, ...]  # whose NEES is too large
    innovations: tuple[str, ...]  # whose NIS is too large
    coloured: tuple[str, ...]  # innovations that are not white


@dataclass(frozen=True, kw_only=True)
class Consistency:
    """What was found."""

    seed: int
    runs: int
    squares: tuple[Squares, ...]
    whiteness: tuple[Whiteness, ...]
    errors: tuple[Errors, ...]

    @property
    def deceived(self) -> tuple[Deceived, ...]:
        """What follows, for each set of sensors and filter."""

        def too_small(case: Errors, kind: str) -> tuple[str, ...]:
            return tuple(
                one.of
                for one in self.squares
                if (one.sensors, one.estimator, one.kind) == (case.sensors, case.estimator, kind)
                and one.verdict == "too small"
            )

        return tuple(
            Deceived(
                sensors=case.sensors,
                estimator=case.estimator,
                states=too_small(case, "NEES"),
                innovations=too_small(case, "NIS"),
                coloured=tuple(
                    one.of
                    for one in self.whiteness
                    if (one.sensors, one.estimator) == (case.sensors, case.estimator) and not one.white
                ),
            )
            for case in self.errors
        )


def cases() -> dict[str, tuple[SensorOptions, Parameters]]:
    """Returns sensors, and what the filters assume of them, by name."""
    delayed = matched(MATCHED)
    prompt = replace(delayed, gps=replace(delayed.gps, latency=0.0))
    return {
        "matched, no latency": (prompt, MATCHED),
        f"matched, {GpsErrors().latency:g} s": (delayed, MATCHED),
        "default": (SensorOptions(), DEFAULT),
    }


def run(seed: int, runs: int = 64) -> Consistency:
    """Examines both filters with all sets of sensors.

    Args:
        seed: Of paths and errors.
        runs: R.
    """
    squares: list[Squares] = []
    whiteness: list[Whiteness] = []
    errors: list[Errors] = []
    for sensors, (options, parameters) in cases().items():
        drives = filter_checks.drive(options, runs, seed, _DURATION)
        for name in EKFS:
            found = watch(name, drives, parameters)
            squares += found.squares(sensors)
            whiteness += found.whiteness(sensors)
            errors.append(found.errors(sensors))
    return Consistency(seed=seed, runs=runs, squares=tuple(squares), whiteness=tuple(whiteness), errors=tuple(errors))


@dataclass(frozen=True, kw_only=True)
class Watched:
    """What an estimator did in R runs once it had settled; times N of samples, F of fixes."""

    estimator: EkfName
    error: Array  # (N, R, 10) in the order of `estimation.motion.NAMES`
    nees: Array  # (N, R, parts) of `PARTS`
    nis: dict[str, Array]  # by measurement, (N or F, R)
    innovation: dict[str, Array]  # by measurement, made unit, (N or F, R, m)

    def squares(self, sensors: str) -> list[Squares]:
        """Judges NEES and NIS."""
        rows: list[Squares] = []
        for index, part in enumerate(PARTS):
            values = self.nees[..., index]
            by_run, runs = values.mean(axis=0), values.shape[1]
            reach = float(stats.t.ppf(0.5 + 0.5 * CONFIDENCE, runs - 1) * by_run.std(ddof=1) / np.sqrt(runs))
            of = "all states" if part == motion.NAMES else " ".join(part)
            low, high = max(len(part) - reach, 0.0), len(part) + reach
            rows.append(self._squares(sensors, "NEES", of, values, len(part), low, high))
        for of, values in self.nis.items():
            components = self.innovation[of].shape[-1]
            low, high = bounds(components, values.size)
            rows.append(self._squares(sensors, "NIS", of, values, components, low, high))
        return rows

    def whiteness(self, sensors: str) -> list[Whiteness]:
        """Judges the innovations."""
        rows = []
        for of, innovation in self.innovation.items():
            correlation = autocorrelation(innovation)
            samples = innovation.shape[0] * innovation.shape[1]
            bound, bound_of_all = (
                float(stats.norm.isf(0.5 * (1.0 - CONFIDENCE) / tests) / np.sqrt(samples))
                for tests in (1, correlation.size)
            )
            worst = np.unravel_index(np.abs(correlation).argmax(), correlation.shape)
            rows.append(
                Whiteness(
                    sensors=sensors,
                    estimator=self.estimator,
                    of=of,
                    components=innovation.shape[-1],
                    samples=samples,
                    largest=float(correlation[worst]),
                    lag=int(worst[0]) + 1,
                    bound=bound,
                    outside=int((np.abs(correlation) > bound).sum()),
                    bound_of_all=bound_of_all,
                )
            )
        return rows

    def errors(self, sensors: str) -> Errors:
        """Measures the errors."""
        return Errors(
            sensors=sensors,
            estimator=self.estimator,
            position_m=float(np.sqrt((self.error[..., motion.POSITION] ** 2).mean())),
            heading_deg=float(np.degrees(np.sqrt((self.error[..., motion.HEADING] ** 2).mean()))),
        )

    def _squares(
        self,
        sensors: str,
        kind: Literal["NEES", "NIS"],
        of: str,
        values: Array,
        components: int,
        low: float,
        high: float,
    ) -> Squares:
        least, most = bounds(components, values.shape[1])
        at_once = values.mean(axis=1)
        return Squares(
            sensors=sensors,
            estimator=self.estimator,
            kind=kind,
            of=of,
            components=components,
            mean=float(values.mean()),
            low=low,
            high=high,
            inside=float(((at_once >= least) & (at_once <= most)).mean()),
        )


def watch(name: EkfName, drives: Drives, parameters: Parameters) -> Watched:
    """Runs a filter and keeps what only the simulation can judge.

    Args:
        name: Of the filter.
        drives: Samples and what was true.
        parameters: The filter's.
    """
    runs = drives.truth.runs
    ekf = CoupledEkf(runs, parameters) if name == "coupled" else DecoupledEkf(runs, parameters)
    estimator = Estimator(ekf, (runs,), parameters)
    assert drives.samples.errors is not None
    truth = ten_states(drives.truth, drives.samples.errors)
    errors: list[Array] = []
    nees: list[Array] = []
    updates: dict[str, list[Update]] = {of: [] for of in ("bearing", *_FIXES[name])}

    def look(index: int) -> None:
        if drives.samples.time[index] < SETTLED:
            return
        state, covariance = ekf.moments()
        error = state - truth[index]
        error[:, motion.HEADING] = wrap(error[:, motion.HEADING])
        errors.append(error)
        nees.append(np.stack([_normalised(error, covariance, part) for part in PARTS], axis=-1))
        assert estimator.bearing_update is not None
        updates["bearing"].append(estimator.bearing_update[1])
        for of, update in zip(_FIXES[name], estimator.fix_updates[1], strict=False):
            updates[of].append(update)

    replay.follow(drives.samples, estimator, look)
    return Watched(
        estimator=name,
        error=np.array(errors),
        nees=np.array(nees),
        nis={of: np.array([one.squared for one in some]) for of, some in updates.items()},
        innovation={of: np.array([unit(one) for one in some]) for of, some in updates.items()},
    )


def bounds(components: int, count: int) -> tuple[float, float]:
    """Returns between what the mean of some normalised squares lies in a consistent filter.

    Args:
        components: Of each error or innovation.
        count: Of the squares.
    """
    low, high = stats.chi2.ppf([0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE], components * count) / count
    return float(low), float(high)


def unit(update: Update) -> Array:
    """Returns innovations whose components should be independent and of variance 1, (M, m)."""
    factor = np.linalg.cholesky(update.innovation_covariance)
    whitened: Array = np.linalg.solve(factor, update.innovation[..., None])
    return whitened[..., 0]


def autocorrelation(values: Array) -> Array:
    """Returns the autocorrelations of sequences of mean zero, (N, R, m), at lags 1 to `LAGS`, (LAGS, m)."""
    power = (values**2).sum(axis=(0, 1))
    return np.stack([(values[:-lag] * values[lag:]).sum(axis=(0, 1)) / power for lag in range(1, LAGS + 1)])


def document(found: Consistency) -> dict[str, Any]:
    """Returns the JSON document."""
    return {
        "seed": found.seed,
        "runs": found.runs,
        "confidence": CONFIDENCE,
        "squares": [{**asdict(one), "verdict": one.verdict} for one in found.squares],
        "whiteness": [{**asdict(one), "lags": LAGS, "white": one.white} for one in found.whiteness],
        "errors": [asdict(one) for one in found.errors],
        "too_small": [asdict(one) for one in found.deceived],
    }


def markdown(found: Consistency) -> str:
    """Returns the tables."""
    squares = [
        [
            one.sensors,
            one.estimator,
            f"{one.kind} {one.of}",
            f"{one.components}",
            f"{one.mean:.2f}",
            f"{one.low:.2f} to {one.high:.2f}",
            f"{100.0 * one.inside:.1f}",
            one.verdict,
        ]
        for one in found.squares
    ]
    whiteness = [
        [
            one.sensors,
            one.estimator,
            one.of,
            f"{one.samples}",
            f"{one.largest:.3f} at {one.lag}",
            f"{one.bound:.3f}",
            f"{one.outside} of {LAGS * one.components}",
            f"{one.bound_of_all:.3f}",
            "white" if one.white else "coloured",
        ]
        for one in found.whiteness
    ]
    errors = [[one.sensors, one.estimator, f"{one.position_m:.3f}", f"{one.heading_deg:.2f}"] for one in found.errors]
    deceived = [
        [
            one.sensors,
            one.estimator,
            *("; ".join(names) or "-" for names in (one.states, one.innovations, one.coloured)),
        ]
        for one in found.deceived
    ]
    lines = [
        f"# Consistency of the filters, {found.runs} runs on the circle, seed {found.seed}",
        "",
        f"Means over runs and times from {SETTLED:g} s to {_DURATION:g} s, beside the {100.0 * CONFIDENCE:g} % bounds",
        "that a consistent filter's mean lies in; `inside`: the share of the times [%] at which the mean over the runs",
        "lies in its own chi-square bounds, 99 in a consistent filter. The last column judges the covariance.",
        "",
        *tables.aligned(
            ["sensors", "filter", "square", "components", "mean", "bounds", "inside", "covariance"], squares
        ),
        "",
        f"Autocorrelation of the innovations at lags 1 to {LAGS}: the largest of all components; the bound of one, and",
        "how many lie outside (1 % would by chance); the bound of the largest.",
        "",
        *tables.aligned(
            ["sensors", "filter", "innovation", "samples", "largest", "bound", "outside", "bound of all", ""], whiteness
        ),
        "",
        "RMS errors, per axis:",
        "",
        *tables.aligned(["sensors", "filter", "position [m]", "heading [deg]"], errors),
        "",
        "Whose covariance is too small, and what a filter could have told it by, not knowing the truth:",
        "",
        *tables.aligned(["sensors", "filter", "covariance too small of", "NIS too large of", "not white"], deceived),
    ]
    return "\n".join(lines) + "\n"


def _normalised(error: Array, covariance: Array, part: Sequence[str]) -> Array:
    """Returns the NEES of some states, (R,)."""
    chosen = [motion.NAMES.index(name) for name in part]
    some = error[:, chosen]
    weighted = np.linalg.solve(covariance[:, chosen][:, :, chosen], some[..., None])[..., 0]
    squared: Array = (some * weighted).sum(axis=-1)
    return squared
