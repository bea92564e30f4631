"""The law of a study: the potential field, or a function of the user's, `my_module:my_law`, in its place."""

import contextlib
import importlib
import sys
import traceback
from pathlib import Path

import numpy as np

from dynabot_mj.common.arrays import Array
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.controllers import potential_field
from dynabot_mj.controllers.law import Information, Law
from dynabot_mj.controllers.potential_field import PotentialField

BUILT_IN = "potential-field"


def build(name: str, field: PotentialField) -> Law:
    """Returns the law of a name.

    Args:
        name: `BUILT_IN`, or a function as `module:function`, which is looked for in the working directory too.
        field: Of the built-in law. Its limit of the force holds for every law: it is the vehicle's.

    Raises:
        InputError: If there is no such function; from the law, if what it returns is no force.
    """
    if name == BUILT_IN:

        def follow_field(known: Information) -> Array:
            return potential_field.total_force(
                known.position_w,
                known.velocity_w,
                known.leader_w,
                known.heard_position_w,
                known.heard_known,
                field,
            )

        return follow_field
    law = _load(name)

    def follow_user(known: Information) -> Array:
        try:
            with contextlib.redirect_stdout(sys.stderr):  # where our own results go is no place for what it prints
                force_w = np.asarray(law(known), dtype=float)
        except Exception as error:  # it is the user's: anything
            raise InputError(f"controller {name!r} failed at {known.time:g} s: {_told(error)}") from error
        if force_w.shape != known.position_w.shape:
            raise InputError(
                f"controller {name!r} returned an array of shape {force_w.shape}, it must be {known.position_w.shape}: "
                "a force on each robot of each trial"
            )
        if not np.isfinite(force_w).all():
            raise InputError(f"controller {name!r} returned a force that is not finite at {known.time:g} s")
        return potential_field.saturate(force_w, field.force_limit)

    return follow_user


def look_in(folder: Path | None) -> None:
    """Lets functions be found in a folder too, behind the working directory."""
    if folder is not None and str(folder) not in sys.path:
        sys.path.append(str(folder))


def source(name: str) -> Path | None:
    """Returns the file of a law of the user's; None for the built-in one, and where there is no file.

    Raises:
        InputError: If there is no such function.
    """
    if name == BUILT_IN:
        return None
    file = getattr(sys.modules[_load(name).__module__], "__file__", None)
    return Path(file) if file else None


def _load(name: str) -> Law:
    module_name, _, function = name.partition(":")
    if not module_name or not function:
        raise InputError(f"controller {name!r} given, it must be {BUILT_IN!r} or my_module:my_law")
    here = str(Path.cwd())
    if here not in sys.path:
        sys.path.insert(0, here)  # commands, and their worker processes, start without it
    try:
        with contextlib.redirect_stdout(sys.stderr):
            law: Law = getattr(importlib.import_module(module_name), function)
    except AttributeError as error:
        raise InputError(f"controller {name!r} given: {error}") from error
    except Exception as error:  # whatever happens in a module of the user's
        raise InputError(f"controller {name!r} cannot be imported: {_told(error)}") from error
    if not callable(law):
        raise InputError(f"controller {name!r} given, it must be a function")
    return law


def _told(error: Exception) -> str:
    """Returns an error of the user's code in one line, and where in it."""
    where = traceback.extract_tb(error.__traceback__)[-1]
    reason = " ".join(str(error).split())
    return f"{type(error).__name__}{f': {reason}' if reason else ''} ({Path(where.filename).name}, line {where.lineno})"
