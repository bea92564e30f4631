"""The paper's tether experiment (Sec. III.B, Table II, Fig. 3): what each estimator makes of the same samples.

A robot is driven around a post, its sensors are recorded, and all estimators follow the record. The paper takes
"the maximum error between the estimated path and the best-fit actual path" as the uncertainty of an estimator. Beside
the circle there are a figure of eight, where the fit may not change the path's size, and a line, where it cannot see
errors along the path.
"""

import json
import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass as plain_dataclass
from dataclasses import fields
from typing import Annotated, Any, Literal, get_args

import numpy as np
from pydantic import Field, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass

from dynabot_mj.common import columns
from dynabot_mj.common.arrays import Progress
from dynabot_mj.common.columns import Columns
from dynabot_mj.common.exceptions import InputError, one_line
from dynabot_mj.common.validation import STRICT, UNITS
from dynabot_mj.experiments.estimators import kinematic, tether
from dynabot_mj.experiments.estimators import scores as estimation_scores
from dynabot_mj.experiments.estimators.best_fit import BestFit
from dynabot_mj.experiments.estimators.kinematic import PathName
from dynabot_mj.experiments.estimators.scores import Consistency, EstimationScores
from dynabot_mj.perception import estimators
from dynabot_mj.perception import options as perception_options
from dynabot_mj.perception.estimators import NAMES, build
from dynabot_mj.perception.options import FilterParameters
from dynabot_mj.sensing import options as sensing_options
from dynabot_mj.sensing import replay
from dynabot_mj.sensing.ground_truth import GroundTruth
from dynabot_mj.sensing.options import SensorOptions
from dynabot_mj.sensing.replay import Samples, Track
from dynabot_mj.study import configuration, execution, methods, provenance
from dynabot_mj.study.chunk import Chunk
from dynabot_mj.study.execution import Execution, ShareWatch
from dynabot_mj.study.methods import Method

PlantName = Literal["kinematic", "rigid"]
PLANTS: tuple[PlantName, ...] = get_args(PlantName)

DROPPED = 15.0  # at the beginning, until the estimators have settled [s]
CHUNK = 50  # runs at once: what bounds the memory

_HERE = Execution()  # in this process
_DRIVING: dict[PlantName, float] = {"kinematic": 0.0, "rigid": 0.8}  # its share of the work


@dataclass(frozen=True, kw_only=True, config=STRICT)
class CircleRequest:
    """What is asked for."""

    runs: Annotated[int, Field(ge=1)] = 200
    seed: Annotated[int, Field(ge=0)] = 0
    # With what is dropped [s]: at least a round of the circle is left; the record of a chunk has to fit in memory.
    duration: Annotated[float, Field(ge=30.0, le=1000.0)] = 100.0
    period: Annotated[float, Field(ge=0.005, le=0.2)] = 0.036  # T_s, between two samples [s]
    plant: PlantName = "kinematic"
    path: PathName = "circle"
    sensors: SensorOptions = SensorOptions()
    filter: FilterParameters = FilterParameters()  # what the estimators assume of them
    method: dict[str, Method] | None = None  # of the user's, beside the paper's three

    @property
    def estimators(self) -> tuple[str, ...]:
        """Names of the methods whose estimators follow the record."""
        return (*NAMES, *(self.method or ()))


@plain_dataclass(frozen=True, kw_only=True)
class Runs:
    """Some runs and what the estimators made of them."""

    first: int  # index of the first sample that counts
    truth: GroundTruth  # at the samples, N times
    samples: Samples  # (N, R, ...)
    tracks: dict[str, Track]
    fits: dict[str, BestFit]  # from the first sample that counts
    scores: dict[str, EstimationScores]


@plain_dataclass(frozen=True, kw_only=True)
class CircleOutcome:
    """What was found."""

    request: CircleRequest
    scores: dict[str, EstimationScores]  # of all runs
    restarts: dict[str, int]  # of the estimators' filters, in all runs
    example: Runs  # that of the first run


def request(tree: Mapping[str, Any], origin: str = "options", **options: Any) -> CircleRequest:
    """Builds a request from a tree of plain values, e.g. of a TOML file, and overriding options.

    Args:
        tree: Keys of `CircleRequest`.
        origin: Where it comes from, for the messages.
        **options: Keys of `CircleRequest`; None where not given.

    Raises:
        InputError: If a key or a value is not allowed, or values do not fit together.
    """
    merged = {**tree, **{key: value for key, value in options.items() if value is not None}}
    if "method" in merged:
        merged["method"] = methods.own(merged["method"])
    try:
        # Strict validation refuses plain dicts for dataclasses; from JSON it accepts them and is as strict otherwise.
        found = TypeAdapter(CircleRequest).validate_json(json.dumps(merged, default=str))
    except ValidationError as error:
        typed = {key: f"--{key}" for key, value in options.items() if value is not None}
        told = one_line(error, typed=typed, units=UNITS)
        raise InputError(told if told.startswith("--") else f"{origin}: {told}") from error
    if found.plant == "rigid":
        if found.path != "circle":
            raise InputError(f"path {found.path!r} given for the rigid plant, its tether allows: circle")
        if abs(found.period / tether.INTERVAL - round(found.period / tether.INTERVAL)) > 1e-6:
            raise InputError(
                f"period = {found.period:g} s given, for the rigid plant it must be a multiple of {tether.INTERVAL:g} s"
            )
    sensing_options.check(found.sensors, robots=1)
    perception_options.check(found.filter)
    methods.check(found.method or {})
    return found


def dump(asked: CircleRequest) -> str:
    """Returns a request as TOML; `request` gives the same one back."""
    return configuration.toml(asked)


def chunks(asked: CircleRequest) -> list[Chunk]:
    """Returns the work: the runs in chunks of fixed size."""
    found = []
    for start in range(0, asked.runs, CHUNK):
        count = min(CHUNK, asked.runs - start)
        found.append(
            Chunk(
                label="circle",
                start=start,
                size=count,
                weight=float(count),
                inputs={**_shared(asked), "runs": [start, start + count]},
                work=_followed,
                arguments=(asked, start, count),
            )
        )
    return found


def _shared(asked: CircleRequest) -> dict[str, Any]:
    """Returns what scores depend on beside their runs."""
    own = {name: row.filter for name, row in (asked.method or {}).items() if row.filter}
    files = {name: file for name, path in own.items() if (file := estimators.source(name, path))}
    tree = {key: value for key, value in tomllib.loads(dump(asked)).items() if key != "runs"}
    return {"circle": tree, "inputs": provenance.digests(files)}


def _followed(asked: CircleRequest, start: int, count: int, *, threads: int, progress: Progress) -> Columns:
    """Returns the scores of some runs, and the restarts of their estimators."""
    found = follow(asked, start, count, progress)
    told: dict[str, Any] = {}
    for name in asked.estimators:
        told |= {f"{name}.{key}": values for key, values in columns.flatten(found.scores[name]).items()}
        told[f"{name}.restarts"] = found.tracks[name].restarts.sum()
    return told


def run(asked: CircleRequest, progress: Progress = lambda share: None, how: Execution = _HERE) -> CircleOutcome:
    """Runs the experiment.

    Args:
        asked: What is asked for.
        progress: Told the share of the work that is done.
        how: How the runs are executed.
    """
    work = chunks(asked)
    results = execution.execute(work, how, ShareWatch(progress))
    found = [results[index] for index in range(len(work))]
    scores = {}
    for name in asked.estimators:
        own = [{key.removeprefix(f"{name}."): values for key, values in part.items()} for part in found]
        scores[name] = _joined([columns.restore(EstimationScores, part) for part in own])
    return CircleOutcome(
        request=asked,
        scores=scores,
        restarts={name: sum(int(part[f"{name}.restarts"]) for part in found) for name in asked.estimators},
        example=follow(asked, 0, 1),  # of the same numbers as among others
    )


def follow(asked: CircleRequest, begin: int, count: int, progress: Progress = lambda share: None) -> Runs:
    """Drives some runs, records their sensors and follows the record with every estimator.

    Args:
        asked: What is asked for.
        begin: Number of the first run.
        count: Number of runs R.
        progress: Told the share of the work that is done.
    """
    driving = _DRIVING[asked.plant]
    driven = _drive(asked, begin, count, lambda share: progress(driving * share))
    samples = replay.record(driven, asked.sensors, asked.period, asked.seed, begin)
    truth = driven.thinned(round(asked.period / driven.interval))
    state = estimation_scores.ten_states(truth, samples)
    first = int(np.searchsorted(truth.time, DROPPED - 1e-9))
    tracks: dict[str, Track] = {}
    fits: dict[str, BestFit] = {}
    scores: dict[str, EstimationScores] = {}
    for index, name in enumerate(asked.estimators):
        estimator = build(name, (count,), asked.filter, own=methods.filter_of(asked.method, name))
        consistency = Consistency(estimator, state, first)
        tracks[name] = replay.follow(samples, estimator, consistency.collect)
        scores[name], fits[name] = estimation_scores.judge(asked.path, tracks[name], truth, consistency, first)
        progress(driving + (1.0 - driving) * (index + 1) / len(asked.estimators))
    return Runs(first=first, truth=truth, samples=samples, tracks=tracks, fits=fits, scores=scores)


def _drive(asked: CircleRequest, begin: int, count: int, progress: Progress) -> GroundTruth:
    """Returns what the vehicles really do, on a grid that divides the sampling period."""
    match asked.plant:
        case "rigid":
            return tether.drive(range(begin, begin + count), asked.seed, asked.duration, progress=progress)
        case "kinematic":
            # As fine as the tethered vehicle's record.
            interval = asked.period / math.ceil(asked.period / tether.INTERVAL - 1e-9)
            return kinematic.follow(asked.path, count, asked.seed, asked.duration, interval, begin)


def _joined(parts: list[EstimationScores]) -> EstimationScores:
    return EstimationScores(
        **{one.name: np.concatenate([getattr(part, one.name) for part in parts]) for one in fields(EstimationScores)}
    )
