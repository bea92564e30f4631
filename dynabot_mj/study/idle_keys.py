"""Which keys of a configuration do nothing in its study: whoever sets one of them expected something else."""

from dataclasses import asdict

from dynabot_mj.common.trees import flat
from dynabot_mj.plants.kinds import any_bodies
from dynabot_mj.study.scenario import Scenario

_TYRES = "the study has point masses alone, which have no tyres, motors or local laws"
_OF_BODIES = ("friction", "slope", "steering", "sensing", "gains")  # model and payload give point masses their mass


def idle(setup: Scenario) -> dict[str, str]:
    """Returns the keys and tables that do nothing, by dotted name, and why.

    A key counts whether or not it is set, see `changed`.
    """
    perfect_alone = set(setup.estimators) == {"perfect"}
    used = set() if perfect_alone else set(setup.perception)
    bodies = any_bodies(setup.plants)
    found = {} if bodies else {f"vehicle.{key}": _TYRES for key in _OF_BODIES}
    if not bodies and "filter" not in used:
        found["start.headings"] = "the study has point masses alone, and no sensors on them"
    for perception, keys in {
        "gauss-markov": ("surrogate",),
        "filter": ("sensors", "filter"),
        "fitted": ("fitted",),
    }.items():
        if perception not in used:
            found |= dict.fromkeys(keys, f"the study has no perception {perception}")
    if perfect_alone:
        why = "the study is of perfect information alone"
        found |= {"perception": why, "processor.utilisation": f"{why}, which no processor limits"}
    return found


def changed(setup: Scenario) -> dict[str, str]:
    """Returns those that are set to something else than their default, and why they do nothing."""
    defaults = dict(flat(asdict(Scenario())))
    different = [key for key, value in flat(asdict(setup)) if value != defaults.get(key)]
    return {
        name: why
        for name, why in idle(setup).items()
        if any(key == name or key.startswith(f"{name}.") for key in different)
    }
