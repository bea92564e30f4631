"""Errors of this package: each message is one line that says what was given and what is allowed."""


class DynabotError(Exception):
    """Base class of the errors that a caller may want to catch."""


class InputError(DynabotError):
    """The input is outside what is allowed; the command line exits with code 2."""


class InfeasibleScheduleError(InputError):
    """No period satisfies Eq. 1, or the periods given load the processor beyond its bound."""


class OutOfFittedRangeError(InputError):
    """The radio model was asked for a fleet or a message outside the range that it was fitted on."""
