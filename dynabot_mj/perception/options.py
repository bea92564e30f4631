"""How the filters and the surrogates of them are run and how large they err: tables of the configuration."""

import functools
import tomllib
from dataclasses import field, fields
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field
from pydantic.dataclasses import dataclass

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.common.validation import LARGEST, STRICT, NotNegative, Positive
from dynabot_mj.estimation.gauss_markov import Component
from dynabot_mj.estimation.parameters import Parameters
from dynabot_mj.perception.estimators import Implementation

_FITTED = Path(__file__).resolve().with_name("fitted.toml")

SigmaName = Literal["radial", "per-axis"]


@dataclass(frozen=True, kw_only=True, config=STRICT)
class SurrogateOptions:
    """The Gauss-Markov error that stands for an estimator."""

    correlation_time: Positive = 0.08  # tau [s]; ours
    sigma: SigmaName = "radial"  # what Table II's figure is the deviation of: the planar distance, or each axis; ours


@dataclass(frozen=True, kw_only=True, config=STRICT)
class FilterParameters(Parameters):
    """What the filters assume of the sensors, of values that are checked to be numbers; `check` has their ranges."""


@dataclass(frozen=True, kw_only=True, config=STRICT)
class FilterOptions(FilterParameters):
    """The real filters: what they assume of the sensors, and how they are run."""

    implementation: Implementation = "batched"  # filterpy: FilterPy's own, one robot at a time
    alignment: Annotated[float, Field(ge=0.0, le=600.0)] = 4.0  # time at rest before the start [s]; ours


@dataclass(frozen=True, kw_only=True, config=STRICT)
class ErrorComponent(Component):
    """A Gauss-Markov sequence, one of those that an error is the sum of."""

    deviation: NotNegative  # sigma, per axis [m], [m/s] or [rad]
    time: Positive  # tau [s]


@dataclass(frozen=True, kw_only=True, config=STRICT)
class FittedError:
    """Errors with the statistics of an estimator's in the loop."""

    position: tuple[ErrorComponent, ...]  # per axis [m]
    velocity: tuple[ErrorComponent, ...] = ()  # per axis [m/s]; (): exact
    heading: tuple[ErrorComponent, ...] = ()  # that local laws use [rad]; (): exact


@functools.cache
def _measured() -> dict[str, Any]:
    """Returns the table of `fitted.toml`, as `compare --perception filter` writes it; `make fitted` made it."""
    table: dict[str, Any] = tomllib.loads(_FITTED.read_text(encoding="utf-8"))["fitted"]
    return table


def _error(estimator: str) -> FittedError:
    return FittedError(
        **{name: tuple(ErrorComponent(**one) for one in part) for name, part in _measured()[estimator].items()}
    )


@dataclass(frozen=True, kw_only=True, config=STRICT)
class FittedOptions:
    """The surrogate that has the filters' measured statistics; `compare --perception filter` writes such a table."""

    # The defaults are those of `fitted.toml`: of particles; rigid bodies err alike.
    # The seed is that of the study that it was fitted on.
    seed: Annotated[int, Field(ge=0)] = field(default_factory=lambda: _measured()["seed"])
    gps: FittedError = field(default_factory=lambda: _error("gps"))
    decoupled: FittedError = field(default_factory=lambda: _error("decoupled"))
    coupled: FittedError = field(default_factory=lambda: _error("coupled"))


def check(parameters: Parameters) -> None:
    """Checks the range of each parameter.

    Raises:
        InputError: With the first one that is out of it.
    """
    for parameter in fields(Parameters):
        value = getattr(parameters, parameter.name)
        share = parameter.name == "gate"
        if not (0.0 < value < 1.0 if share else 0.0 < value <= LARGEST):
            allowed = "between 0 and 1" if share else f"positive and at most {LARGEST:g}"
            raise InputError(f"filter.{parameter.name} = {value:g} given, it must be {allowed}")
