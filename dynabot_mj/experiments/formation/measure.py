"""What a measure is: one entry of the table `measures.MEASURES`, from which all that tells of cases is made."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Generic, Literal, TypeVar, get_args

import xarray as xr

from dynabot_mj.common.arrays import Array
from dynabot_mj.testbed.paper import TableIIIRow

S = TypeVar("S")  # the summary of a case: of `common.intervals`, or of `summaries`
Factor = Literal["estimator", "plant", "perception"]
FACTORS: tuple[Factor, ...] = get_args(Factor)
TableName = Literal["cases", "readings"]  # of `compare_tables`, of `sensitivity`
FigureName = Literal["outcomes", "table_iii", "differences", "sensitivity"]  # whose panels are measures


@dataclass(frozen=True, kw_only=True)
class Column(Generic[S]):
    """A column of a table of cases."""

    header: str  # with the unit
    text: Callable[[S], str]
    tables: tuple[TableName, ...] = ("cases",)
    rank: int = 0  # columns of a higher rank stand behind those of a lower, equal ones as in the table of measures


@dataclass(frozen=True, kw_only=True)
class PaperColumn(Generic[S]):
    """A column of the table beside the paper's Table III."""

    header: str  # with the unit
    text: Callable[[S, TableIIIRow | None], str]  # of a case, beside its row of the paper, if it has one


@dataclass(frozen=True, kw_only=True)
class Ranking:
    """How estimators are put in order by a measure."""

    title: str
    better: Literal["lower", "higher"]


@dataclass(frozen=True, kw_only=True)
class Measure(Generic[S]):
    """What is told of every case."""

    name: str  # in JSON and CSV, with the unit
    summary: Callable[[xr.Dataset], S]  # of one case
    columns: tuple[Column[S], ...] = ()
    paper_columns: tuple[PaperColumn[S], ...] = ()  # the first has the paper's own value too
    published: Callable[[TableIIIRow], S] | None = None  # the paper's own value, where it has `paper_columns`
    note: str = ""  # what explains the columns, below their table; {horizon} is the duration
    panels: Mapping[FigureName, str] = field(default_factory=dict)  # titles of panels, with the unit; {horizon} too
    scale: float = 1.0  # of what figures and differences show
    ranking: Ranking | None = None  # None: estimators are not put in order by it


@dataclass(frozen=True, kw_only=True)
class PairedMeasure(Measure[S]):
    """One number per trial, by which cases are compared on the same trials.

    It says what it may be concluded from: what two cases may differ in, so that a difference of the measure is one of
    the robots and not of the measure.
    """

    title: str  # of a column of differences, with its unit
    values: Callable[[xr.Dataset], Array]  # of one case, (trials,); NaN where undefined
    rate: bool = False  # zeros and ones
    digits: int = 2
    factors: tuple[Factor, ...] = FACTORS  # that it is compared over
    tested: bool = True  # False: shown for continuity, nothing is concluded from it
    censored: bool = False  # at the duration, beyond which it may be anything: the median is told too
    counted: bool = False  # the number of trials is told, where many may have no value
    margin: float | None = None  # within which two cases are equivalent; a share of the duration where `censored`
    paired_rank: int = 0  # measures of a higher rank are compared after those of a lower

    @property
    def unit(self) -> str:
        """What differences are told in: as the title says, or points of per cent."""
        return self.title.partition("[")[2].rstrip("]") or "points"


@dataclass(frozen=True, kw_only=True)
class PairedRate(PairedMeasure[S]):
    """Zeros and ones, one per trial; told in per cent."""

    scale: float = 100.0
    rate: bool = True
    digits: int = 0
