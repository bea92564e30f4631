"""One case of a study, summarised over its trials: a row of the tables and of the JSON document."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import xarray as xr

from dynabot_mj.experiments.formation import in_loop
from dynabot_mj.experiments.formation.in_loop import EstimateError
from dynabot_mj.experiments.formation.measures import MEASURES
from dynabot_mj.testbed.paper import TABLE_III


@dataclass(frozen=True, kw_only=True)
class Published:
    """The same row of the paper's Table III."""

    settling_s: float
    collision: float
    completion: float


@dataclass(frozen=True, kw_only=True)
class CaseRow:
    """One case, summarised over its trials; diverged trials count in `diverged` and nowhere else."""

    plant: str
    perception: str | None
    estimator: str
    trials: int
    period_ms: float  # T_c
    sample_period_ms: float  # T_s
    alpha_h: float
    alpha_d: float
    measured: Mapping[str, Any]  # the summary by each of `MEASURES`, by its name
    overturned: int | None  # None: an older study does not tell
    diverged: int
    velocity: str  # where the dissipation's comes from
    estimate_error: EstimateError | None  # None for perfect information
    paper: Published | None  # None: it has no such row

    @property
    def label(self) -> str:
        """Of the case, e.g. `particle/gauss-markov/gps`."""
        return "/".join(part for part in (self.plant, self.perception, self.estimator) if part)


def document(row: CaseRow) -> dict[str, Any]:
    """Returns a row of the JSON document, each measure under its own name."""
    found: dict[str, Any] = {}
    for name, value in asdict(row).items():
        found |= value if name == "measured" else {name: value}
    return found


def rows(study: xr.Dataset) -> list[CaseRow]:
    """Summarises every case of a study."""
    return [row(study.isel(case=index)) for index in range(study.sizes["case"])]


def row(case: xr.Dataset) -> CaseRow:
    """Summarises one case of a study's Dataset."""
    estimator = str(case.estimator.item())
    return CaseRow(
        plant=str(case.plant.item()),
        perception=str(case.perception.item()) or None,
        estimator=estimator,
        trials=case.sizes["trial"],
        # The periods are whole ticks; the digits beyond are floating-point noise.
        period_ms=round(1e3 * case.control_period.item(), 9),
        sample_period_ms=round(1e3 * case.sample_period.item(), 9),
        alpha_h=case.alpha_h.item(),
        alpha_d=case.alpha_d.item(),
        measured={one.name: one.summary(case) for one in MEASURES},
        overturned=int(case.overturned.notnull().sum()) if "overturned" in case.variables else None,
        diverged=int(case.diverged.sum()),
        velocity=str(case.velocity.item()),
        estimate_error=in_loop.errors(case),
        paper=_published(estimator),
    )


def _published(estimator: str) -> Published | None:
    if (row := TABLE_III.get(estimator)) is None:
        return None
    return Published(settling_s=row.settling, collision=row.collision, completion=row.completion)
