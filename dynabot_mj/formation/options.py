"""Options of the task: the potential field but for its gains, the start, completion."""

from typing import Literal, get_args

from pydantic.dataclasses import dataclass

from dynabot_mj.common.validation import STRICT, NotNegative, Positive
from dynabot_mj.formation.geometry import Fit
from dynabot_mj.testbed import paper

HeadingChoice = Literal["random", "leader"]
HEADINGS: tuple[HeadingChoice, ...] = get_args(HeadingChoice)


@dataclass(frozen=True, kw_only=True, config=STRICT)
class FieldOptions:
    """The potential field but for its gains, which belong to the method."""

    spacing: Positive = paper.SPACING  # d_0, side of the polygon that the robots form [m]; h_0 follows from it
    width: Positive = paper.WELL_WIDTH  # epsilon, of both wells' floors [m]
    leader_range: Positive = 60.0  # h_l [m]; ours: beyond the start distance, so that the leader attracts from there
    # d_l [m]; ours: 10 m up to five robots. More of them do not form within that range: auto is 7.5 m then.
    neighbour_range: Positive | Literal["auto"] = "auto"
    closest: Positive = 0.05  # distance below which a force no longer grows [m]; ours
    dissipation: NotNegative = 13.0  # c [N s/m]; ours


@dataclass(frozen=True, kw_only=True, config=STRICT)
class StartOptions:
    """The start: at rest, in a regular polygon whose centroid is some way from the leader, turned at random."""

    distance: Positive = paper.START_DISTANCE  # of the centroid from the leader [m]
    spacing: Positive = paper.START_SPACING  # side of the polygon [m]
    headings: HeadingChoice = "random"  # random: uniform; leader: facing the leader


@dataclass(frozen=True, kw_only=True, config=STRICT)
class CompletionOptions:
    """The paper's completion, within each method's own sigma."""

    fit: Fit = "least-squares"  # of the polygon that positions are measured against, see `geometry`; ours
