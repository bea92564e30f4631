"""The rows that are compared: Table III's methods, an estimator each with its gains and periods."""

from typing import Annotated, Any, Literal

from pydantic import Field
from pydantic.dataclasses import dataclass

from dynabot_mj.common.validation import STRICT, NotNegative, Positive
from dynabot_mj.testbed import paper

PositiveOrInfinite = Annotated[float, Field(gt=0.0)]


@dataclass(frozen=True, kw_only=True, config=STRICT)
class Method:
    """One row of Table III: an estimator, and the gains and periods that go with it."""

    alpha_h: Positive  # gain of the leader's potential [N m]
    alpha_d: Positive  # gain of the inter-robot potential [N m]
    uncertainty: NotNegative  # sigma of the position estimate [m]; 0: perfect information, and no radio
    estimation_time: NotNegative  # t_se [s]
    force_limit: PositiveOrInfinite = 50.0  # of the norm of the total command [N]; inf: none
    sample_period: Positive | Literal["auto"] = "auto"  # T_s [s]; auto: Eq. 3, rounded to the timer's tick
    control_period: Positive | Literal["auto"] = "auto"  # T_c [s]; auto: the sample period


def _method(name: str, **others: Any) -> Method:
    row, figures = paper.TABLE_III[name], paper.TABLE_II.get(name)
    return Method(
        alpha_h=row.alpha_h,
        alpha_d=row.alpha_d,
        uncertainty=figures.uncertainty if figures else 0.0,
        estimation_time=figures.estimation_time if figures else 0.0,
        **others,
    )


@dataclass(frozen=True, kw_only=True, config=STRICT)
class Methods:
    """The rows that can be compared."""

    # The paper's 10 ms is the authors' choice and outside Eq. 2. The row's first command is 52 N, and it is the
    # best case "for the given control parameters", so it is not limited.
    perfect: Method = _method("perfect", sample_period=paper.TABLE_III["perfect"].period, force_limit=float("inf"))
    gps: Method = _method("gps")
    decoupled: Method = _method("decoupled")
    coupled: Method = _method("coupled")
