"""Options of the robot as a computer: the processor that tasks share, and the messages."""

from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass

from dynabot_mj.common.validation import STRICT, Positive
from dynabot_mj.testbed import paper, schedule


@dataclass(frozen=True, kw_only=True, config=STRICT)
class ProcessorOptions:
    """The processor that the tasks share."""

    # U of Eq. 1
    utilisation: Annotated[float, Field(gt=0.0, le=1.0, allow_inf_nan=False)] = paper.UTILISATION_TABLE_III
    tick: Positive = schedule.TICK  # of the timer [s]


@dataclass(frozen=True, kw_only=True, config=STRICT)
class RadioOptions:
    """The messages."""

    message_bytes: Annotated[int, Field(ge=1, le=paper.RADIO_MAX_BYTES)] = 20  # N of Eqs. 4-5; ours
