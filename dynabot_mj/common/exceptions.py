"""Errors of this package: each message is one line that says what was given and what is allowed."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from decimal import Decimal
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pydantic import ValidationError


class DynabotError(Exception):
    """Base class of the errors that a caller may want to catch.

    Example:
        >>> try:
        ...     dy.shortest_period(9, 0.02)
        ... except dy.DynabotError as error:
        ...     print(error)
        9 robots given, allowed are 2 to 7
    """

    def __str__(self) -> str:
        """Returns the message in one line, whatever names and values of the user's are in it."""
        return "".join(one if one.isprintable() else repr(one)[1:-1] for one in super().__str__())


class InputError(DynabotError):
    """The input is outside what is allowed; the command line exits with code 2.

    Example:
        >>> dy.build_scenario({"trials": 0})
        Traceback (most recent call last):
        dynabot_mj.common.exceptions.InputError: options: trials = 0: input should be greater than or equal to 1
    """


class InfeasibleScheduleError(InputError):
    """No period satisfies Eq. 1, or the periods given load the processor beyond its bound.

    Example:
        >>> issubclass(dy.InfeasibleScheduleError, dy.InputError)
        True
        >>> dy.build_scenario({"method": {"gps": {"sample_period": 0.02}}})  # doctest: +ELLIPSIS
        Traceback (most recent call last):
        dynabot_mj.common.exceptions.InfeasibleScheduleError: ... the shortest common period is 27.05 ms
    """


class OutOfFittedRangeError(InputError):
    """The radio model was asked for a fleet or a message outside the range that it was fitted on.

    Example:
        >>> dy.dynabot_link(8, 20)
        Traceback (most recent call last):
        dynabot_mj.common.exceptions.OutOfFittedRangeError: 8 robots given, the radio model was fitted for 2 to 7
    """


_NONE: Mapping[str, str] = {}
_BOUNDS = ("greater_than", "greater_than_equal", "less_than", "less_than_equal")  # messages that end with a value


def suggestion(given: str, allowed: Iterable[str]) -> str:
    """Returns `; did you mean ...?` where something that is allowed is much like what was given, else nothing."""
    near = difflib.get_close_matches(given, list(allowed), n=1, cutoff=0.6)
    return f"; did you mean {near[0]}?" if near else ""


def one_line(
    error: ValidationError,
    allowed: Iterable[str] = (),
    typed: Mapping[str, str] = _NONE,
    units: Mapping[str, str] = _NONE,
) -> str:
    """Returns pydantic's findings as `key = value: what is allowed`, joined.

    Args:
        error: Pydantic's.
        allowed: The keys that there are, with those of their tables: `radio.message_bytes`.
        typed: What the user typed in place of a key, such as `--duration`.
        units: Of values, by the key without its tables.
    """
    lines: dict[str, str] = {}
    # Of the branches of a union, the one that fits best is complained of deepest inside.
    for found in sorted(error.errors(include_url=False), key=lambda found: -len(found["loc"])):
        # Behind the field's own name, a union names its branch (such as "constrained-float") and a tuple its index.
        key = ".".join(part for part in found["loc"] if isinstance(part, str) and part.isidentifier())
        if found["type"] in ("extra_forbidden", "unexpected_keyword_argument"):
            last = str(found["loc"][-1])
            # A name that could not stand in a dotted key is not in it.
            inside = f" in {key}" if key else ""
            told = f"{key}{suggestion(key, allowed)}" if last.isidentifier() else f"{last!r}{inside}"
            lines[f"{key} {last}"] = f"unknown key {told}"
        elif found["type"] == "missing" and isinstance(found["loc"][-1], str):
            lines[key] = f"{key} is missing, it must be given"
        else:
            # What a union or a tuple adds behind its first finding is about our types, not about the input.
            given, most = found["input"], found.get("ctx", {}).get("le")
            is_number = isinstance(given, int | float) and not isinstance(given, bool)
            value, unit = (_number(given) if is_number else repr(given)), units.get(key.rpartition(".")[2], "")
            told = f"{typed[key]} {value}" if key in typed else f"{key} = {value}"
            told += f": {found['msg'][0].lower()}{found['msg'][1:]}"
            if unit and found["type"] in _BOUNDS:
                told += f" {unit}"
            if most == 1.0 and isinstance(given, int | float) and 1.0 < given <= 100.0:
                told += f"; a fraction is meant: {given / 100.0:g}?"
            lines.setdefault(key, told)
    return "; ".join(lines.values())


def _number(value: float) -> str:
    try:
        return f"{value:g}"
    except OverflowError:  # a whole number may have hundreds of digits
        return f"{Decimal(value):.6g}"
