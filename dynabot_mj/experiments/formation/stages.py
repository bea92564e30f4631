"""Where the loop's time goes: CPU time of what it calls, told apart by stage."""

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, ParamSpec, TypeVar

from dynabot_mj.trial import loop
from dynabot_mj.trial.judge import Judge
from dynabot_mj.trial.loop import Parts

STAGES: Mapping[str, str] = {
    "estimate": "what robots are told of themselves: sensors, and filters or errors",
    "radio": "messages sent and heard",
    "law": "from what robots know to forces",
    "plant": "their motion; of rigid robots local laws and physics",
    "judge": "scores",
    "rest": "the loop and the robots' memory",
}
"""The stages, and what they are."""

_P = ParamSpec("_P")
_T = TypeVar("_T")


def shares(parts: Parts, judge: Judge) -> dict[str, float]:
    """Runs trials and returns the share of each of `STAGES` in the CPU time.

    Args:
        parts: What the trials are made of.
        judge: Of them; what is called of both is timed from then on.
    """
    spent = dict.fromkeys(STAGES, 0.0)

    def timed(stage: str, function: Callable[_P, _T]) -> Callable[_P, _T]:
        def call(*args: _P.args, **kwargs: _P.kwargs) -> _T:
            begin = time.process_time()
            result = function(*args, **kwargs)
            spent[stage] += time.process_time() - begin
            return result

        return call

    watched: list[tuple[str, Any, tuple[str, ...]]] = [
        ("estimate", parts.perception, ("observe", "navigation_error", "substep")),
        ("radio", parts.radio, ("broadcast", "heard")),
        ("plant", parts.plant, ("step",)),
        ("judge", judge, ("event", "substep")),
    ]
    for stage, part, names in watched:
        for name in names:
            setattr(part, name, timed(stage, getattr(part, name)))
    begin = time.process_time()
    loop.simulate(replace(parts, law=timed("law", parts.law)), [judge])
    total = time.process_time() - begin
    spent["rest"] = total - sum(spent.values())
    return {stage: seconds / total for stage, seconds in spent.items()}
