"""The rows that are compared: an estimator each with its gains and periods; Table III's, and the user's."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Annotated, Any, Literal

from pydantic import Field
from pydantic.dataclasses import dataclass

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.common.validation import STRICT, NotNegative, Positive
from dynabot_mj.perception import estimators
from dynabot_mj.perception.methods import GAINS, METHODS

PositiveOrInfinite = Annotated[float, Field(gt=0.0)]


@dataclass(frozen=True, kw_only=True, config=STRICT)
class Method:
    """One row: an estimator, and the gains and periods that go with it."""

    alpha_h: Positive  # gain of the leader's potential [N m]
    alpha_d: Positive  # gain of the inter-robot potential [N m]
    uncertainty: NotNegative  # sigma of the position estimate [m]; 0: perfect information, and no radio
    estimation_time: NotNegative  # t_se [s]
    force_limit: PositiveOrInfinite = 50.0  # of the norm of the total command [N]; inf: none
    sample_period: Positive | Literal["auto"] = "auto"  # T_s [s]; auto: Eq. 3, rounded to the timer's tick
    control_period: Positive | Literal["auto"] = "auto"  # T_c [s]; auto: the sample period
    # `my_module:MyFilter`, a filter of the user's, see docs/own-estimator.md; None: the method is built in.
    filter: str | None = None


def _built_in(name: str) -> Method:
    record = METHODS[name]
    shared = {one.name: getattr(record, one.name) for one in fields(Method) if hasattr(record, one.name)}
    return Method(**{**shared, "sample_period": record.sample_period or "auto", "filter": None})


# Of the paper: what studies compare unless told otherwise.
PUBLISHED = tuple(name for name, record in METHODS.items() if record.row)
BUILT_IN: Mapping[str, Method] = {name: _built_in(name) for name in METHODS}


def merged(given: Any) -> Any:
    """Returns a tree of methods, with what its rows do not set: a row that sets one gain keeps the others."""
    if not isinstance(given, Mapping):
        return given
    defaults: dict[str, dict[str, Any]] = {
        name: {one.name: getattr(row, one.name) for one in fields(Method)} for name, row in BUILT_IN.items()
    }
    return {**defaults, **{name: _filled(defaults.get(name, GAINS), row) for name, row in given.items()}}


def own(given: Any) -> Any:
    """Returns a tree of methods of the user's alone, with what its rows do not set."""
    return {name: _filled(GAINS, row) for name, row in given.items()} if isinstance(given, Mapping) else given


def check(rows: Mapping[str, Method]) -> None:
    """Checks that what is built in keeps its filter, and that the user's methods have one.

    Raises:
        InputError: With the first that does not, or whose filter cannot be had.
    """
    for name, row in rows.items():
        if name in BUILT_IN and row.filter is not None:
            raise InputError(
                f"method.{name}.filter = {row.filter!r} given, but {name} is built in; give yours its own name"
            )
        if name in BUILT_IN:
            continue
        if not name.isidentifier():
            raise InputError(f"[method.{name}] given, a method's name has letters, digits and _ alone")
        if row.filter is None:
            raise InputError(f"[method.{name}] given without a filter, it must have one: filter = 'my_module:MyFilter'")
        estimators.source(name, row.filter)


def filter_of(rows: Mapping[str, Method] | None, name: str) -> str | None:
    """Returns the filter of a method of the user's; None of one that is built in."""
    return rows[name].filter if rows is not None and name in rows else None


def _filled(defaults: Mapping[str, Any], row: Any) -> Any:
    return {**defaults, **row} if isinstance(row, Mapping) else row
