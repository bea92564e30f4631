"""How a trial is shown in time: a clock to be halted and set, replayed snapshots, and a simulation held back to it."""

import bisect
import time
from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np

from dynabot_mj.plants.plant import FleetState
from dynabot_mj.study import scenario
from dynabot_mj.study.assembly import simulate
from dynabot_mj.study.scenario import Scenario
from dynabot_mj.trial.loop import Event
from dynabot_mj.viewing.recording import Recording
from dynabot_mj.viewing.stage import Snapshot

FRAME = 1.0 / 30.0  # between two pictures of a simulation, and of the wall's clock [s]

_RUSH = 0.1  # what a simulation may be late by and still catch up; a slow one would fall behind for good [s]


class Clock:
    """Simulated time that follows the wall's, faster or slower; a viewer's callbacks may set it from their threads."""

    def __init__(self, speed: float, wall: Callable[[], float] = time.monotonic) -> None:
        """Starts at zero.

        Args:
            speed: Simulated seconds per second.
            wall: Tells the time [s].
        """
        self._wall, self._speed, self._playing = wall, speed, True
        self._since = (wall(), 0.0)  # replaced as one

    @property
    def time(self) -> float:
        """Simulated time now [s]."""
        wall, simulated = self._since
        return simulated + (self._speed * (self._wall() - wall) if self._playing else 0.0)

    @time.setter
    def time(self, value: float) -> None:
        self._since = (self._wall(), value)

    @property
    def speed(self) -> float:
        """Simulated seconds per second."""
        return self._speed

    @speed.setter
    def speed(self, value: float) -> None:
        self.time = self.time
        self._speed = value

    @property
    def playing(self) -> bool:
        """Whether it runs."""
        return self._playing

    @playing.setter
    def playing(self, value: bool) -> None:
        self.time = self.time
        self._playing = value


class Screen(Protocol):
    """Where a trial is shown."""

    @property
    def open(self) -> bool:
        """Whether anyone can look at it still."""
        ...

    def show(self, snapshots: Sequence[Snapshot], index: int) -> None:
        """Shows one of the snapshots, and where the robots have been before."""
        ...

    def settle(self) -> None:
        """Takes note that the whole trial is known, so that any time of it can be chosen."""
        ...


class ClosedError(Exception):
    """The screen was closed while the simulation ran."""


def replay(snapshots: Sequence[Snapshot], screen: Screen, clock: Clock) -> None:
    """Shows snapshots by the clock until the screen is closed; at the end the clock halts, and starts anew if told to.

    Args:
        snapshots: In the order of time.
        screen: Where they are shown.
        clock: By which.
    """
    times, halted = [snapshot.time for snapshot in snapshots], False
    screen.settle()
    while screen.open:
        if halted and clock.playing and clock.time >= times[-1]:
            clock.time = times[0]
        halted = clock.time >= times[-1]
        if halted:
            clock.playing = False
            clock.time = times[-1]
        screen.show(snapshots, max(0, bisect.bisect_right(times, clock.time + 1e-9) - 1))
        time.sleep(FRAME)


class Pacer:
    """Shows the first of the trials that are simulated while they run, and holds them back to the clock."""

    def __init__(self, screen: Screen, clock: Clock, robots: int) -> None:
        """Has seen nothing yet.

        Args:
            screen: Where the trial is shown.
            clock: Before whose time it is not.
            robots: Number of robots n.
        """
        self.snapshots: list[Snapshot] = []  # that were shown, to be replayed
        self._screen, self._clock, self._next = screen, clock, 0.0
        self._believed_w = np.full((robots, 2), np.nan)

    def event(self, event: Event) -> None:
        """Takes what the robots believe from now on."""
        self._believed_w = np.where(event.belief.known[0, :, None], event.belief.position_w[0], np.nan)

    def substep(self, state: FleetState) -> None:
        """Shows a state where a picture is due, once the clock has come to its time.

        Raises:
            ClosedError: If the screen is closed.
        """
        if state.time < self._next - 1e-9:
            return
        self._next += FRAME
        while (early := state.time - self._clock.time) > 0.0:
            self._refresh()
            time.sleep(min(FRAME, early / self._clock.speed))
        if early < -_RUSH * self._clock.speed:
            self._clock.time = state.time
        pose = None if state.pose is None else state.pose[0].copy()
        self.snapshots.append(
            Snapshot(time=state.time, position_w=state.position_w[0], pose=pose, believed_w=self._believed_w)
        )
        self._refresh()

    def _refresh(self) -> None:
        """Shows the latest state, which a screen may be told to show differently while the clock is halted."""
        if not self._screen.open:
            raise ClosedError
        if self.snapshots:
            self._screen.show(self.snapshots, len(self.snapshots) - 1)


def live(setup: Scenario, screen: Screen, clock: Clock) -> list[Snapshot] | None:
    """Simulates one trial of one case while it is shown.

    Args:
        setup: Of that trial, see `scenario.one_trial`.
        screen: Where it is shown.
        clock: Before whose time it is not.

    Returns:
        What was shown, to be replayed; None if the screen was closed meanwhile.
    """
    (case,) = scenario.cases(setup)
    pacer = Pacer(screen, clock, setup.robots)
    try:
        simulate(setup, case, [setup.first_trial], observers=[pacer])
    except ClosedError:
        return None
    return pacer.snapshots


def snapshots(recording: Recording) -> list[Snapshot]:
    """Returns what is seen of a recording."""
    return [
        Snapshot(
            time=float(recording.time[k]),
            position_w=recording.position_w[k],
            pose=None if recording.pose is None else recording.pose[k],
            believed_w=recording.believed_w[k],
        )
        for k in range(len(recording.time))
    ]
