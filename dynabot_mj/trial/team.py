"""What the robots' computers know: each one's belief of itself, and what it has heard of the others."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.controllers.law import Information
from dynabot_mj.perception.belief import Belief, Perception, certain
from dynabot_mj.plants.plant import FleetState
from dynabot_mj.testbed.radio import Heard, Message, Radio


@dataclass(frozen=True, kw_only=True)
class Sample:
    """What became of a sampling event."""

    told: Belief  # by the perception; void of robots that were not due
    sent: BoolArray  # (B, n) who broadcasts
    message: Message  # what is broadcast


def own_velocity(told: Belief) -> Array:
    """Returns the velocity that robots believe they have, (B, n, 2) [m/s]."""
    return told.velocity_w


class Team:
    """Robots that sample, broadcast and listen, at the same instants in the study's loop and in the environment."""

    def __init__(
        self,
        perception: Perception,
        radio: Radio,
        leader_w: Array,
        start: FleetState,
        velocity: Callable[[Belief], Array] = own_velocity,
    ) -> None:
        """Starts with robots that know nothing.

        Args:
            perception: Tells them about themselves.
            radio: Between them.
            leader_w: (2,) known to all, exactly and at once [m].
            start: Their true state at time 0.
            velocity: Of the dissipation, (B, n, 2), from what a robot is told at a sample [m/s].
        """
        self._perception, self._radio, self._leader_w, self._velocity = perception, radio, leader_w, velocity
        self._shape = start.heading.shape
        nothing = certain(start.position_w, np.zeros_like(start.position_w))
        self.belief = replace(nothing, known=np.zeros(self._shape, dtype=bool))
        self.heard: Heard = radio.heard(np.zeros(self._shape))  # as of the latest time that they listened

    def sample(self, state: FleetState, time: float, due: BoolArray) -> Sample:
        """Samples robots and broadcasts what they believe now.

        Args:
            state: True state of the fleet.
            time: By the robots' clock [s].
            due: Which robots, (B, n).
        """
        told = self._perception.observe(state, due)
        self.belief = self.belief.renewed(replace(told, velocity_w=self._velocity(told)), due)
        sent = due & self.belief.known
        message = self._radio.broadcast(self.belief.position_w, np.full(self._shape, time), sent)
        return Sample(told=told, sent=sent, message=message)

    def listen(self, time: float) -> Information:
        """Takes what has arrived by a time [s], and returns all that the robots know then."""
        now = np.full(self._shape, time)
        self.heard = self._radio.heard(now)
        return Information(
            time=time,
            position_w=self.belief.position_w,
            velocity_w=self.belief.velocity_w,
            leader_w=self._leader_w,
            heard_position_w=self.heard.position_w,
            heard_known=self.heard.known,
            heard_age=now[..., None] - self.heard.sampled_at,
        )
