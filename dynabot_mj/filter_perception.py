"""Real filters on simulated sensors, in each robot of each trial."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dynabot_mj.arrays import Array, BoolArray
from dynabot_mj.perception import Belief
from dynabot_mj.plants import FleetState, NavigationError
from dynabot_mj.sensors import GRAVITY, SensorOptions, Sensors
from estimation.estimator import Estimator
from estimation.measurements import wrap


class FilterPerception:
    """An estimator per robot; each starts before the trial does, at rest."""

    def __init__(
        self,
        estimator: Estimator,
        options: SensorOptions,
        sample_period: float,
        seed: int,
        trials: Sequence[int],
        start: FleetState,
        *,
        alignment: float,
        uphill: float = 0.0,
    ) -> None:
        """Aligns the estimators.

        Args:
            estimator: Of as many robots as the start has, (B, n).
            options: Errors of the sensors.
            sample_period: T_s [s].
            seed: Seed of the study.
            trials: Numbers of the trials, length B.
            start: The state at time zero, at rest.
            alignment: For how long the robots have been at rest then [s].
            uphill: Rise of the ground per metre toward +x: at rest, accelerometers feel it.
        """
        self._estimator = estimator
        everybody = np.ones(start.heading.shape, dtype=bool)
        felt = GRAVITY * np.sin(np.arctan(uphill))
        felt_b = felt * np.stack([np.cos(start.heading), -np.sin(start.heading)], axis=-1)
        self._sampled_at = np.zeros(start.heading.shape)
        self._error = NavigationError(
            heading=np.zeros(start.heading.shape), yaw_rate=np.zeros(start.heading.shape), acceleration_b=0.0 * felt_b
        )

        def rest(time: float) -> FleetState:
            return replace(start, time=time, specific_impulse_b=start.specific_impulse_b + time * felt_b)

        samples = max(1, round(alignment / sample_period))
        times = [-sample_period * (samples - index) for index in range(samples)]
        self._sensors = Sensors(options, sample_period, seed, trials, rest(times[0]))
        for time in times:
            self.look(rest(time))
            self.observe(rest(time), everybody)

    def look(self, state: FleetState) -> None:
        """Lets the receivers latch their fixes."""
        self._sensors.look(state)

    def observe(self, state: FleetState, due: BoolArray) -> Belief:
        """Reads the sensors of the robots that are due, and estimates."""
        imu, fix = self._sensors.sample(state, due)
        estimate = self._estimator.step(imu, fix, due)
        known = estimate.known
        self._sampled_at = np.where(due, state.time, self._sampled_at)
        last = self._error
        # A robot that does not know where it is stands still: there is nothing to mislead its local laws.
        fresh = NavigationError(
            heading=np.where(known, wrap(estimate.heading - state.heading), 0.0),
            yaw_rate=np.where(known, self._sensors.yaw_rate_error - estimate.yaw_rate_bias, 0.0),
            acceleration_b=np.where(known[..., None], self._sensors.force_error_b - estimate.acceleration_bias_b, 0.0),
        )
        self._error = NavigationError(
            heading=np.where(due, fresh.heading, last.heading),
            yaw_rate=np.where(due, fresh.yaw_rate, last.yaw_rate),
            acceleration_b=np.where(due[..., None], fresh.acceleration_b, last.acceleration_b),
        )
        return Belief(position_w=estimate.position_w, velocity_w=estimate.velocity_w, known=known)

    def navigation_error(self, time: float) -> NavigationError:
        """Returns what the local laws' signals are off by at a time [s]."""
        since: Array = time - self._sampled_at
        return replace(self._error, heading=self._error.heading + since * self._error.yaw_rate)
