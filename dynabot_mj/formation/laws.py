"""The law of a study: the potential field, or a function of the user's, `my_module:my_law`, in its place."""

from pathlib import Path

import numpy as np

from dynabot_mj.common.arrays import Array
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.controllers import potential_field
from dynabot_mj.controllers.law import Information, Law
from dynabot_mj.controllers.potential_field import PotentialField
from dynabot_mj.host import user_code

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
        with user_code.called(f"controller {name!r} failed at {known.time:g} s"):
            force_w = np.asarray(law(known), dtype=float)
        if force_w.shape != known.position_w.shape:
            raise InputError(
                f"controller {name!r} returned an array of shape {force_w.shape}, it must be {known.position_w.shape}: "
                "a force on each robot of each trial"
            )
        if not np.isfinite(force_w).all():
            raise InputError(f"controller {name!r} returned a force that is not finite at {known.time:g} s")
        return potential_field.saturate(force_w, field.force_limit)

    return follow_user


def source(name: str) -> Path | None:
    """Returns the file of a law of the user's; None for the built-in one, and where there is no file.

    Raises:
        InputError: If there is no such function.
    """
    return None if name == BUILT_IN else user_code.source(_load(name))


def _load(name: str) -> Law:
    law: Law = user_code.load(f"controller {name!r}", name, f"{BUILT_IN!r} or my_module:my_law")
    return law
