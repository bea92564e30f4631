"""How the filters and the surrogates of them are run and how large they err: tables of the configuration."""

from collections.abc import Sequence
from dataclasses import fields
from typing import Annotated, Literal

from pydantic import Field
from pydantic.dataclasses import dataclass

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.common.validation import LARGEST, STRICT, NotNegative, Positive
from dynabot_mj.estimation.gauss_markov import Component
from dynabot_mj.estimation.parameters import Parameters
from dynabot_mj.perception.estimators import Implementation

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


def _error(**parts: Sequence[tuple[float, float]]) -> FittedError:
    return FittedError(
        **{
            name: tuple(ErrorComponent(deviation=sigma, time=tau) for sigma, tau in pairs)
            for name, pairs in parts.items()
        }
    )


@dataclass(frozen=True, kw_only=True, config=STRICT)
class FittedOptions:
    """The surrogate that has the filters' measured statistics; `compare --perception filter` writes such a table."""

    seed: Annotated[int, Field(ge=0)] = 0  # of the study that it was fitted on
    # Measured by `dynabot compare --perception filter`, 100 trials of seed 0, particles; rigid bodies err alike.
    gps: FittedError = _error(
        position=[(1.02, 0.128), (0.726, 78.8)], velocity=[(0.245, 0.211)], heading=[(0.0806, 154.0)]
    )
    decoupled: FittedError = _error(
        position=[(0.174, 2.86), (0.722, 97.0)], velocity=[(0.0809, 0.733)], heading=[(0.0825, 40.4)]
    )
    coupled: FittedError = _error(position=[(0.7, 141.0)], velocity=[(0.0804, 0.729)], heading=[(0.0846, 84.2)])


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
