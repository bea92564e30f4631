"""Beliefs without sensors: exact ones, and errors that stand for an estimator's (`estimation/gauss_markov`)."""

from collections.abc import Sequence

import numpy as np

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.common.streams import Draws, Purpose
from dynabot_mj.estimation import gauss_markov
from dynabot_mj.estimation.gauss_markov import Component
from dynabot_mj.perception.belief import Belief, certain
from dynabot_mj.plants.plant import FleetState, NavigationError


class _Ideal:
    """What perceptions without sensors of their own have in common."""

    def substep(self, state: FleetState) -> None:
        """Nothing is sensed between samples."""

    def navigation_error(self, time: float) -> NavigationError | None:
        """Local laws have ideal signals."""
        return None


class PerfectPerception(_Ideal):
    """True position and velocity: the row "perfect information" of Table III."""

    def observe(self, state: FleetState, due: BoolArray) -> Belief:
        """Returns the true state."""
        return certain(state.position_w, state.velocity_w)


class ErrorSequence:
    """An error of every robot: a sum of Gauss-Markov sequences, sampled with the robots."""

    def __init__(
        self, components: Sequence[Component], sample_period: float, shape: tuple[int, ...], draws: Draws
    ) -> None:
        """Starts with errors from the stationary distribution.

        Args:
            components: That are added up.
            sample_period: T_s [s].
            shape: Of one sample, (B, n, ...).
            draws: Standard normal numbers, (B, n, ..., components) each.
        """
        self._components, self._draws = tuple(components), draws
        self._rho = [gauss_markov.correlation(sample_period, component.time) for component in components]
        self._zero = np.zeros(shape)
        self._errors = [self._zero for _ in components]
        self._started = np.zeros(shape[:2], dtype=bool)

    def next(self, due: BoolArray) -> Array:
        """Returns the error of this sample; that of robots that are not due stays, (B, n, ...)."""
        normal, trailing = self._draws.next(), (1,) * (self._zero.ndim - 2)
        started, drawn = (mask.reshape(*mask.shape, *trailing) for mask in (self._started, due))
        for index, (component, rho) in enumerate(zip(self._components, self._rho, strict=True)):
            sigma, own = component.deviation, normal[..., index]
            before = self._errors[index]
            error = np.where(started, gauss_markov.following(before, sigma, rho, own), gauss_markov.first(sigma, own))
            self._errors[index] = np.where(drawn, error, before)
        self._started = self._started | due
        return sum(self._errors, self._zero)


class GaussMarkovPerception(_Ideal):
    """True state plus the Gauss-Markov position error of Sec. IV; the velocity is exact."""

    def __init__(
        self,
        deviation: float,
        correlation_time: float,
        sample_period: float,
        robots: int,
        seed: int,
        trials: Sequence[int],
    ) -> None:
        """Starts with errors from the stationary distribution.

        Args:
            deviation: Of each axis [m].
            correlation_time: tau [s].
            sample_period: T_s [s].
            robots: Number of robots n.
            seed: Seed of the study.
            trials: Numbers of the trials, length B.
        """
        self._variance = deviation**2
        self._error = ErrorSequence(
            [Component(deviation=deviation, time=correlation_time)],
            sample_period,
            (len(trials), robots, 2),
            Draws(seed, trials, Purpose.ESTIMATION_ERROR, (robots, 2, 1), normal=True),
        )

    def observe(self, state: FleetState, due: BoolArray) -> Belief:
        """Returns the true state with the position off by the errors of this sample."""
        return certain(state.position_w + self._error.next(due), state.velocity_w, self._variance)


class FittedPerception:
    """True state plus errors with the statistics that an estimator's have in the loop: how large, and for how long."""

    def __init__(
        self,
        position: Sequence[Component],
        velocity: Sequence[Component],
        heading: Sequence[Component],
        sample_period: float,
        robots: int,
        seed: int,
        trials: Sequence[int],
    ) -> None:
        """Starts with errors from the stationary distribution.

        Args:
            position: Of the position, per axis [m].
            velocity: Of the velocity, per axis [m/s].
            heading: Of the heading that local laws use [rad].
            sample_period: T_s [s].
            robots: Number of robots n.
            seed: Seed of the study.
            trials: Numbers of the trials, length B.
        """
        shape = (len(trials), robots)
        self._variance = sum(component.deviation**2 for component in position)
        purposes = (Purpose.FITTED_POSITION, Purpose.FITTED_VELOCITY, Purpose.FITTED_HEADING)
        self._position, self._velocity, self._heading = (
            ErrorSequence(
                components,
                sample_period,
                (*shape, *axes),
                Draws(seed, trials, purpose, (robots, *axes, len(components)), normal=True),
            )
            for components, axes, purpose in zip((position, velocity, heading), ((2,), (2,), ()), purposes, strict=True)
        )
        self._heading_error = np.zeros(shape)

    def observe(self, state: FleetState, due: BoolArray) -> Belief:
        """Returns the true state with the errors of this sample."""
        self._heading_error = self._heading.next(due)
        position_w = state.position_w + self._position.next(due)
        return certain(position_w, state.velocity_w + self._velocity.next(due), self._variance)

    def substep(self, state: FleetState) -> None:
        """Nothing is sensed between samples."""

    def navigation_error(self, time: float) -> NavigationError:
        """Returns the heading's error; gyro and accelerometer have none here."""
        return NavigationError(
            heading=self._heading_error, yaw_rate=np.zeros_like(self._heading_error), acceleration_b=None
        )
