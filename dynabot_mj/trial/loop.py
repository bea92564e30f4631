"""The one loop: sample, send, deliver, command, advance; for both plants and all trials at once.

The loop walks the merged calendar of sampling and control events, in whole ticks of the processor's timer, and serves
at each event the robots that are due. It cannot tell which plant it drives or which perception it has: that is what
makes the comparison fair. Whoever judges, records or shows trials observes it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from dynabot_mj.common.arrays import Array, BoolArray, Progress
from dynabot_mj.controllers.law import Information, Law
from dynabot_mj.perception.belief import Belief, Perception
from dynabot_mj.plants.plant import FleetState, NavigationError, Plant
from dynabot_mj.testbed.radio import Heard, Radio
from dynabot_mj.trial.clocks import Clocks
from dynabot_mj.trial.team import Sample, Team, own_velocity


@dataclass(frozen=True, kw_only=True)
class Parts:
    """What trials are made of; B of them, whose numbers the parts' random streams know.

    Attributes:
        clocks: When robots sample and act.
        plant: The robots.
        perception: What they are told of themselves.
        radio: Between them.
        law: From what robots know to a force on each, (B, n, 2) [N].
        leader_w: (2,) known to every robot exactly and at once [m].
        velocity: Of the dissipation, (B, n, 2), at a sample [m/s].

    Example:
        >>> from dataclasses import replace
        >>> setup = dy.build_scenario({"trials": 2, "duration": 1.0, "plants": ["particle"], "estimators": ["gps"]})
        >>> parts = dy.make_parts(setup, dy.cases(setup)[0], trials=range(2))
        >>> idle = replace(parts, law=lambda known: np.zeros_like(known.position_w))
        >>> dy.run_parts(idle)
        >>> float(abs(idle.plant.state.velocity_w).max())
        0.0
    """

    clocks: Clocks
    plant: Plant
    perception: Perception
    radio: Radio
    law: Law
    leader_w: Array
    velocity: Callable[[Belief], Array] = own_velocity


@dataclass(frozen=True, kw_only=True)
class Event:
    """What robots know and do at an event, and until the next one."""

    time: float  # [s]
    state: FleetState  # the truth
    acting: BoolArray  # (B, n) whose control period begins
    sampling: BoolArray  # (B, n) who sample
    sample: Sample | None  # None where nobody samples
    information: Information | None  # on which they act; None where nobody does
    belief: Belief
    heard: Heard  # as of the latest control event
    force_w: Array  # (B, n, 2) command [N]
    error: NavigationError | None  # of what the local laws run on


class Observer(Protocol):
    """Watches trials without touching them.

    Example:
        >>> class Forces:
        ...     def __init__(self):
        ...         self.largest = 0.0
        ...     def event(self, event):
        ...         self.largest = max(self.largest, float(np.linalg.norm(event.force_w, axis=-1).max()))
        ...     def substep(self, state):
        ...         pass
        >>> setup = dy.build_scenario({"trials": 2, "duration": 1.0, "plants": ["particle"], "estimators": ["gps"]})
        >>> forces = Forces()
        >>> outcome = dy.simulate(setup, dy.cases(setup)[0], range(2), observers=[forces])
        >>> round(forces.largest, 6) <= 50.0  # its limit [N]
        True
    """

    def event(self, event: Event) -> None:
        """Takes an event, after the robots have decided."""
        ...

    def substep(self, state: FleetState) -> None:
        """Takes a state on the way to the next event; the first is the start, before any event."""
        ...


# A trial that blows up may overflow on the way to being reported as diverged.
@np.errstate(over="ignore", invalid="ignore")
def simulate(parts: Parts, observers: Sequence[Observer] = (), progress: Progress = lambda share: None) -> None:
    """Runs trials.

    Args:
        parts: What they are made of; the plant is left as it is at the end.
        observers: Are shown everything.
        progress: Called now and then.

    Example:
        >>> setup = dy.build_scenario({"trials": 2, "duration": 1.0, "plants": ["particle"], "estimators": ["gps"]})
        >>> parts = dy.make_parts(setup, dy.cases(setup)[0], trials=range(2))
        >>> dy.run_parts(parts)
        >>> parts.plant.state.time
        1.0
    """
    clocks, plant, perception = parts.clocks, parts.plant, parts.perception
    team = Team(perception, parts.radio, parts.leader_w, plant.state, parts.velocity)
    force_w = np.zeros_like(plant.state.position_w)
    for observer in observers:
        observer.substep(plant.state)
    for now, then in clocks.events():
        state, time, information = plant.state, now * clocks.tick, None
        sampling, acting = clocks.due(now, state.heading.shape)
        sample = team.sample(state, time, sampling) if sampling.any() else None
        if acting.any():
            information = team.listen(time)
            command_w = np.where(team.belief.known[..., None], parts.law(information), 0.0)
            force_w = np.where(acting[..., None], command_w, force_w)
        event = Event(
            time=time,
            state=state,
            acting=acting,
            sampling=sampling,
            sample=sample,
            information=information,
            belief=team.belief,
            heard=team.heard,
            force_w=force_w,
            error=perception.navigation_error(state.time),
        )
        for observer in observers:
            observer.event(event)
        for substep in plant.step(force_w, (then - now) * clocks.tick, event.error):
            perception.substep(substep)
            for observer in observers:
                observer.substep(substep)
        progress(then / clocks.duration_ticks)
