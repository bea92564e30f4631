"""The 802.11b broadcast radio of the test bed: Eqs. 4-7 of the paper.

Latency belongs to a message (all receivers get it at the same time, if at all), loss to a receiver:

    L_m    = t_k floor(0.08 N + 21 + 5.25 (n - 1) + k_m),     k_m ~ Poisson(lambda)             Eqs. 4, 6
    lambda = (0.018 n - 0.02) N + 0.06 n^2 - 0.15 n + 3                                         Eq. 5
    p_loss = (1.01 n^2 - 2.82 n + 2.04) 10^-3                                                   Eq. 7

for n robots and messages of N bytes. The authors fitted it for n <= 7 and N <= 125.
"""

import functools
import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import special

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.common.exceptions import OutOfFittedRangeError
from dynabot_mj.common.streams import Draws, Purpose
from dynabot_mj.testbed.paper import RADIO_MAX_BYTES, RADIO_MAX_ROBOTS, RADIO_TICK

# A message that arrives with an event is heard at it. Both times are sums of floats, far less apart than this where
# they are the same: with periods of 13 or 26 ms, multiples of t_k, every tenth such message came a period late.
_SAME_TIME = 1e-9  # [s]


@functools.cache
def _poisson_distribution(mean: float) -> Array:
    """Returns P(k <= 0), P(k <= 1), ... up to where it rounds to one, so that it inverts every double below one."""
    cumulative = special.pdtr(np.arange(int(mean + 12.0 * math.sqrt(mean)) + 40), mean)
    return np.append(cumulative[cumulative < 1.0], 1.0)


@dataclass(frozen=True, kw_only=True)
class Link:
    """Distribution of latency and loss of one broadcast message.

    Attributes:
        offset: Constant part of Eq. 4's bracket, before the floor [ticks].
        poisson_mean: lambda of Eq. 5 [ticks].
        tick: t_k [s].
        loss: p_rm of Eq. 7, per receiver.

    Example:
        >>> link = dy.Link(offset=30.0, poisson_mean=0.0, tick=0.001, loss=0.1)
        >>> link.latency(np.array([0.2, 0.9]))
        array([0.03, 0.03])
    """

    offset: float
    poisson_mean: float
    tick: float
    loss: float

    def latency(self, uniform: Array) -> Array:
        """Returns latencies by inverting the distribution of Eqs. 4 and 6.

        Args:
            uniform: Numbers on [0, 1), one per message, any shape.

        Returns:
            Latencies of the same shape [s].
        """
        k = np.searchsorted(_poisson_distribution(self.poisson_mean), uniform, side="right")
        return self.tick * np.floor(self.offset + k)


def dynabot_link(robots: int, message_bytes: float) -> Link:
    """Returns the fitted model of Eqs. 4-7.

    Args:
        robots: Number of communicating robots n, 2 to 7.
        message_bytes: Message length N, 1 to 125 bytes.

    Raises:
        OutOfFittedRangeError: Outside the range that the authors measured.

    Example:
        >>> link = dy.dynabot_link(robots=3, message_bytes=20)
        >>> round(link.offset, 2), round(link.poisson_mean, 2), round(link.loss, 5)  # ticks, ticks, probability
        (33.1, 3.77, 0.00267)
    """
    if not 2 <= robots <= RADIO_MAX_ROBOTS:
        raise OutOfFittedRangeError(f"{robots} robots given, the radio model was fitted for 2 to {RADIO_MAX_ROBOTS}")
    if not 1 <= message_bytes <= RADIO_MAX_BYTES:
        raise OutOfFittedRangeError(
            f"messages of {message_bytes:g} bytes given, the radio model was fitted for 1 to {RADIO_MAX_BYTES}"
        )
    n, length = robots, message_bytes
    return Link(
        offset=0.08 * length + 21.0 + 5.25 * (n - 1),
        poisson_mean=(0.018 * n - 0.02) * length + (0.06 * n**2 - 0.15 * n + 3.0),
        tick=RADIO_TICK,
        loss=(1.01 * n**2 - 2.82 * n + 2.04) * 1e-3,
    )


# "Perfect, instantaneous position information" (Sec. IV, Fig. 4).
INSTANT_LINK = Link(offset=0.0, poisson_mean=0.0, tick=RADIO_TICK, loss=0.0)


@dataclass(frozen=True, kw_only=True)
class Heard:
    """What each receiver knows of each sender; receiver i and sender j at [..., i, j]."""

    position_w: Array  # (B, n, n, 2) newest position that has arrived [m]; meaningless where not known
    sampled_at: Array  # (B, n, n) when its sender sampled it [s]; -inf where not known
    known: BoolArray  # (B, n, n) whether anything has arrived yet; never true of oneself


@dataclass(frozen=True, kw_only=True)
class Message:
    """One broadcast of all robots, on its way."""

    position_w: Array  # (B, n, 2) [m]
    sampled_at: Array  # (B, n) [s]
    arrives_at: Array  # (B, n, n) [s]; inf where lost, where the sender did not send, and for the sender itself


class Radio:
    """Messages in flight between the robots, and the newest that have arrived.

    Example:
        >>> radio = dy.Radio(dy.dynabot_link(3, 20), robots=3, seed=0, trials=[0])
        >>> message = radio.broadcast(np.zeros((1, 3, 2)), np.zeros((1, 3)), np.array([[True, False, False]]))
        >>> radio.heard(np.full((1, 3), 0.1)).known[0]  # receivers by senders, 0.1 s later
        array([[False, False, False],
               [ True, False, False],
               [ True, False, False]])
    """

    def __init__(self, link: Link, robots: int, seed: int, trials: Sequence[int]) -> None:
        """Starts with nothing in flight and nobody heard.

        Args:
            link: Distribution of latency and loss.
            robots: Number of robots n.
            seed: Seed of the study.
            trials: Numbers of the trials, length B.
        """
        self._link = link
        self._latency = Draws(seed, trials, Purpose.LATENCY, (robots,))
        self._loss = Draws(seed, trials, Purpose.LOSS, (robots, robots))
        self._in_flight: deque[Message] = deque()
        self._self = np.eye(robots, dtype=bool)
        self._position_w = np.zeros((len(trials), robots, robots, 2))
        self._sampled_at = np.full((len(trials), robots, robots), -np.inf)

    def broadcast(self, position_w: Array, sampled_at: Array, due: BoolArray) -> Message:
        """Sends one message from each robot that is due to all others.

        Args:
            position_w: Position that each robot believes it has, (B, n, 2) [m].
            sampled_at: When it was sampled, and is sent, (B, n) [s].
            due: Which robots send, (B, n).

        Returns:
            What is on its way now, and what will never arrive.
        """
        latency = self._link.latency(self._latency.next())
        lost = self._loss.next() < self._link.loss
        never = lost | self._self | ~due[:, None, :]
        arrives_at = np.where(never, np.inf, (sampled_at + latency)[:, None, :])
        message = Message(position_w=position_w.copy(), sampled_at=sampled_at.copy(), arrives_at=arrives_at)
        self._in_flight.append(message)
        return message

    def heard(self, now: Array) -> Heard:
        """Delivers what has arrived and returns what each robot knows of the others.

        Messages overtake each other; what counts is the newest *sampled* one that has arrived.

        Args:
            now: Each receiver's time, (B, n) [s]; it must not go back.
        """
        for message in self._in_flight:
            arrived = message.arrives_at <= now[..., None] + _SAME_TIME
            newer = arrived & (message.sampled_at[:, None, :] > self._sampled_at)
            self._sampled_at = np.where(newer, message.sampled_at[:, None, :], self._sampled_at)
            self._position_w = np.where(newer[..., None], message.position_w[:, None], self._position_w)
        earliest = now.min() + _SAME_TIME
        while self._in_flight and not np.any(np.isfinite(a := self._in_flight[0].arrives_at) & (a > earliest)):
            self._in_flight.popleft()
        return Heard(position_w=self._position_w, sampled_at=self._sampled_at, known=self._sampled_at > -np.inf)
