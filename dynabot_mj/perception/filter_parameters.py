"""The `[filter]` table of a configuration: what the filters assume of the sensors, as pydantic and we check it."""

from dataclasses import fields

from pydantic.dataclasses import dataclass

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.common.validation import LARGEST, STRICT
from dynabot_mj.estimation.parameters import Parameters


@dataclass(frozen=True, kw_only=True, config=STRICT)
class FilterParameters(Parameters):
    """The same with values that are checked to be numbers; `check` tells whether they are allowed."""


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
