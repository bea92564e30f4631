"""Real filters on simulated sensors, in each robot of each trial."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.common.frames import to_body
from dynabot_mj.controllers.vehicle import GRAVITY
from dynabot_mj.estimation.estimator import Estimator
from dynabot_mj.estimation.measurements import wrap
from dynabot_mj.perception.belief import Belief
from dynabot_mj.plants.plant import FleetState, NavigationError
from dynabot_mj.sensing.options import SensorOptions
from dynabot_mj.sensing.sensors import Sensors


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
        felt_b = to_body(np.array([felt, 0.0]), start.heading)
        self._sampled_at = np.zeros(start.heading.shape)
        self._heading_error, self._yaw_rate_error = np.zeros(start.heading.shape), np.zeros(start.heading.shape)
        self._force_error_b = np.zeros((*start.heading.shape, 2))

        def rest(time: float) -> FleetState:
            return replace(start, time=time, velocity_increment_b=start.velocity_increment_b + time * felt_b)

        samples = max(1, round(alignment / sample_period))
        times = [-sample_period * (samples - index) for index in range(samples)]
        self._sensors = Sensors(options, sample_period, seed, trials, rest(times[0]))
        for time in times:
            self.substep(rest(time))
            self.observe(rest(time), everybody)
        self.substep(rest(0.0))

    def substep(self, state: FleetState) -> None:
        """Lets the receivers latch their fixes."""
        self._sensors.substep(state)

    def observe(self, state: FleetState, due: BoolArray) -> Belief:
        """Reads the sensors of the robots that are due, and estimates."""
        imu, fix = self._sensors.sample(state, due)
        estimate = self._estimator.step(imu, fix, due)
        known = estimate.known
        self._sampled_at = np.where(due, state.time, self._sampled_at)
        # A robot that does not know where it is stands still: there is nothing to mislead its local laws.
        misled = due & known
        self._heading_error = np.where(misled, wrap(estimate.heading - state.heading), self._heading_error)
        self._yaw_rate_error = np.where(
            misled, self._sensors.yaw_rate_error - estimate.yaw_rate_bias, self._yaw_rate_error
        )
        self._force_error_b = np.where(
            misled[..., None], self._sensors.force_error_b - estimate.acceleration_bias_b, self._force_error_b
        )
        return Belief(
            position_w=estimate.position_w,
            velocity_w=estimate.velocity_w,
            position_covariance=estimate.position_covariance,
            known=known,
            stale=estimate.stale,
            restarts=estimate.restarts,
        )

    def navigation_error(self, time: float) -> NavigationError:
        """Returns what the local laws' signals are off by at a time [s]."""
        since: Array = time - self._sampled_at
        return NavigationError(
            heading=self._heading_error + since * self._yaw_rate_error,
            yaw_rate=self._yaw_rate_error,
            acceleration_b=self._force_error_b,
        )
