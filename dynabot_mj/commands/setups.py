"""From the options of a command to the configuration of its study."""

import argparse
import sys
from collections.abc import Mapping
from typing import Any

from dynabot_mj.common.exceptions import InputError

_VEHICLE = ("model", "friction", "slope", "payload", "steering", "sensing", "gains")
SCIENCE = (
    "seed",
    "robots",
    "duration",
    "utilisation",
    "headings",
    "velocity",
    "controller",
    "trials",
    *_VEHICLE,
)  # they override the TOML
_NONE: Mapping[str, Any] = {}
_OPTIONS = {"implementation": "filters", "first_trial": "trial"}  # that are called otherwise than their keys


def build(options: argparse.Namespace, defaults: Mapping[str, Any] = _NONE, **others: Any) -> Any:
    """Builds the configuration: defaults, then the file, then the options.

    Raises:
        InputError: If it contradicts itself, or an option does nothing in this study.
    """
    from dynabot_mj.study import configuration

    given, typed = overriding(options, **others)
    if options.config:
        setup = configuration.load_file(options.config, defaults, typed, **given)
    else:
        setup = configuration.build(defaults, typed=typed, **given)
    look_for_idle(options, setup, typed)
    return setup


def overriding(options: argparse.Namespace, **others: Any) -> tuple[dict[str, Any], dict[str, str]]:
    """Returns the keys that options override, and what was typed to set each, by the key with its table."""
    from dynabot_mj.study import configuration

    given = {**{name: getattr(options, name, None) for name in SCIENCE}, **others}
    tables = configuration.TABLES
    single = {"estimators": "estimator", "plants": "plant"} if hasattr(options, "estimator") else {}
    typed = {
        f"{tables[name]}.{name}" if name in tables else name: f"--{single.get(name) or _OPTIONS.get(name, name)}"
        for name, value in given.items()
        if value is not None
    }
    return given, typed


def look_for_idle(options: argparse.Namespace, setup: Any, typed: Mapping[str, str]) -> None:
    """Refuses options that do nothing in a study, and says which keys of its file do nothing."""
    from dynabot_mj.plants.kinds import any_bodies
    from dynabot_mj.study import idle_keys

    idle = idle_keys.idle(setup)
    for key, option in typed.items():
        if why := idle.get(key) or idle.get(key.rpartition(".")[0]):
            raise InputError(f"{option} given, but {why}")
    if getattr(options, "threads", 1) > 1 and not any_bodies(setup.plants):
        raise InputError(f"--threads {options.threads} given, but they are MuJoCo's, and the study has no rigid robots")
    for why in dict.fromkeys((changed := idle_keys.changed(setup)).values()):
        keys = ", ".join(key for key, reason in changed.items() if reason == why)
        print(f"note: {keys} in {options.config}: no effect, since {why}", file=sys.stderr)
    if not any_bodies(setup.plants) and {"vehicle.model", "vehicle.payload"} & set(typed):
        print("note: of the vehicle point masses take the mass and the footprint", file=sys.stderr)
