"""The methods that are built in, one record each: how a method estimates, what it is called, and its row of the paper.

To add one, write its filter (the protocol `dynabot_mj.estimation.estimator.Filter`) and its record here.
"""

import zlib
from dataclasses import dataclass

from dynabot_mj.common.legend import PERCEPTION_NAMES
from dynabot_mj.testbed import paper


@dataclass(frozen=True, kw_only=True)
class MethodRecord:
    """A method: an estimator, and the gains and periods that go with it."""

    label: str  # in figures, films and reports
    colour: str  # there, as `#rrggbb`
    filter: str | None = None  # `module:Class`, all robots at once; None: it knows the truth
    twin: str | None = None  # the same on FilterPy, one robot at a time
    uncertainty: float  # sigma of the position estimate [m]; 0: perfect information, and no radio
    estimation_time: float  # t_se [s]
    alpha_h: float  # gain of the leader's potential [N m]
    alpha_d: float  # gain of the inter-robot potential [N m]
    force_limit: float = 50.0  # of the norm of the total command [N]
    sample_period: float | None = None  # T_s [s]; None: Eq. 3, rounded to the timer's tick
    row: paper.TableIIIRow | None = None  # of the paper


def _of_the_paper(name: str, **others: str | float) -> MethodRecord:
    row, figures = paper.TABLE_III[name], paper.TABLE_II.get(name)
    return MethodRecord(
        uncertainty=figures.uncertainty if figures else 0.0,
        estimation_time=figures.estimation_time if figures else 0.0,
        alpha_h=row.alpha_h,
        alpha_d=row.alpha_d,
        row=row,
        **others,  # type: ignore[arg-type]
    )


_FILTERS, _TWINS = "dynabot_mj.estimation", "dynabot_mj.estimation.filterpy_twins"

# Colours: Tol's "muted" and "bright", none of them a robot's or a perception's.
METHODS = {
    # The paper's 10 ms is the authors' choice and outside Eq. 2. The row's first command is 52 N, and it is the
    # best case "for the given control parameters", so it is not limited.
    "perfect": _of_the_paper(
        "perfect",
        label="perfect information",
        colour="#777777",
        sample_period=paper.TABLE_III["perfect"].period,
        force_limit=float("inf"),
    ),
    "gps": _of_the_paper(
        "gps",
        label="GPS",
        colour="#AA3377",
        filter=f"{_FILTERS}.gps_extrapolation:GpsExtrapolation",
        twin=f"{_TWINS}.gps_extrapolation:GpsExtrapolation",
    ),
    "decoupled": _of_the_paper(
        "decoupled",
        label="decoupled EKF",
        colour="#332288",
        filter=f"{_FILTERS}.decoupled_ekf:DecoupledEkf",
        twin=f"{_TWINS}.decoupled_ekf:DecoupledEkf",
    ),
    "coupled": _of_the_paper(
        "coupled",
        label="coupled EKF",
        colour="#999933",
        filter=f"{_FILTERS}.coupled_ekf:CoupledEkf",
        twin=f"{_TWINS}.coupled_ekf:CoupledEkf",
    ),
}
# Of methods of the user's, which are called by their names; the gains of one that sets none are these.
_SPARE_COLOURS = ("#44AA99", "#882255", "#DDCC77", "#4477AA", "#EE6677", "#AA4499")
GAINS = {"alpha_h": METHODS["decoupled"].alpha_h, "alpha_d": METHODS["decoupled"].alpha_d}


def label(name: str, perception: str | None = None) -> str:
    """Returns what a method is called in figures, with its perception where one is given."""
    own = METHODS[name].label if name in METHODS else name
    return f"{own}, {PERCEPTION_NAMES[perception]}" if perception else own


def colour(name: str) -> str:
    """Returns a method's colour, which is the same in every figure; of one of the user's, one of six by its name."""
    return METHODS[name].colour if name in METHODS else _SPARE_COLOURS[zlib.crc32(name.encode()) % len(_SPARE_COLOURS)]
