"""From what robots really do to what their sensors say of it.

GPS        position and velocity every 200 ms, latched at the fix's own time and delivered later; white errors, slow
           Gauss-Markov errors, of which a share is common to all robots.
Inertial   averages over the sampling period, as a unit's own filter gives them: accelerometer ahead and to the left,
           gyro about the vertical; white noise, a bias from switching on, a drift, a scale error.
Ground     tilts the robot: unevenness, which passes in tenths of a second, and a slope that stays. Both leak gravity
           into the accelerometer: 0.17 m/s^2 per degree. What a rigid body adds by pitching and rolling is part of its
           specific force already.
Magnetic   heading, drawn off by iron on the robot (once and twice per turn), by its motors, and by white noise.
Wheels     speeds and motor currents, with the resolution of their converters.

Errors of the inertial unit are drawn at the beginning of the period that they hold for, since local laws use its
signals within the period. Each event takes one row of random numbers for all robots of a trial, whoever samples. A
missing sample is NaN.
"""

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import special

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.common.streams import Draws, Purpose, generators
from dynabot_mj.controllers.vehicle import GRAVITY
from dynabot_mj.estimation import gauss_markov
from dynabot_mj.estimation.measurements import GpsFix, ImuSample, rotation, wrap
from dynabot_mj.estimation.motion import turned
from dynabot_mj.plants.plant import FleetState
from dynabot_mj.sensing.faults import Faults
from dynabot_mj.sensing.options import SensorOptions


@dataclass(frozen=True, kw_only=True)
class _Fix:
    """A fix of every robot, on its way or arrived."""

    position_w: Array  # (B, n, 2) [m]
    velocity_w: Array  # (B, n, 2) [m/s]
    true_at: Array  # (B, n) [s]
    received: BoolArray  # (B, n); of one that has arrived: and not read yet


@dataclass(frozen=True, kw_only=True)
class _Reading:
    """What the inertial averages of the next sample begin with."""

    time: Array  # (B, n) [s]
    heading: Array  # (B, n) [rad]
    impulse_b: Array  # (B, n, 2) [m/s]


class Sensors:
    """The sensors of all robots of some trials."""

    _slow_w: Array  # GPS position, each robot's own slow error, (B, n, 2) [m]
    _common_w: Array  # the same, of all robots of a trial, (B, 1, 2) [m]
    _slow_velocity_w: Array  # GPS velocity, (B, n, 2) [m/s]

    def __init__(
        self, options: SensorOptions, sample_period: float, seed: int, trials: Sequence[int], start: FleetState
    ) -> None:
        """Switches them on; the first fix is of now.

        Args:
            options: Their errors.
            sample_period: T_s, of the inertial averages [s].
            seed: Seed of the study.
            trials: Numbers of the trials, length B.
            start: The state now.
        """
        shape = start.heading.shape
        robots = shape[1]
        self._options, self._period = options, sample_period
        self._faults = Faults(options.faults, seed, trials, robots)
        self._imu_draws = Draws(seed, trials, Purpose.IMU, (robots, 10), normal=True)
        self._tilt_draws = Draws(seed, trials, Purpose.TILT, (robots, 2), normal=True)
        self._mean_tilt = gauss_markov.period_mean(sample_period, options.ground.unevenness_time)
        self._fix_draws = Draws(seed, trials, Purpose.GPS, (robots + 1, 8), normal=True)
        self._switch_on(
            np.array([g.standard_normal((robots + 1, 22)) for g in generators(seed, trials, Purpose.SWITCH_ON)])
        )
        self._force_error, self._gyro_error, self._magnetic_error = (
            np.zeros((*shape, 2)),
            np.zeros(shape),
            np.zeros(shape),
        )
        self._force_fault, self._gyro_fault = np.zeros((*shape, 2)), np.zeros(shape)
        self._felt_b, self._turning = np.zeros((*shape, 2)), np.zeros(shape)  # the last finite samples
        self._draw(np.ones(shape, dtype=bool))
        self._read = _Reading(
            time=np.full(shape, start.time), heading=start.heading, impulse_b=start.velocity_increment_b
        )
        self._under_way: deque[_Fix] = deque()
        nothing = np.full((*shape, 2), np.nan)
        self._newest = _Fix(
            position_w=nothing, velocity_w=nothing, true_at=nothing[..., 0], received=np.zeros(shape, dtype=bool)
        )
        self._looked, self._next_fix = start, start.time
        self.substep(start)

    @property
    def force_error_b(self) -> Array:
        """What the accelerometers are off by in the period that has begun, but for their scale, (B, n, 2) [m/s^2]."""
        return self._force_error + self._force_fault + turned(rotation(-self._read.heading), self._slope_w)

    @property
    def yaw_rate_error(self) -> Array:
        """What the gyros are off by in the period that has begun, but for their scale, (B, n) [rad/s]."""
        return self._gyro_error + self._gyro_fault

    @property
    def slow_errors(self) -> Array:
        """What estimators know as biases, now: gyro [rad/s], accelerometer [m/s^2], GPS position [m], (B, n, 5)."""
        gps = self._options.gps
        slow_w = math.sqrt(1.0 - gps.common) * self._slow_w + math.sqrt(gps.common) * self._common_w
        return np.concatenate(
            [
                (self._gyro_bias + self._gyro_drift)[..., None],
                self._force_bias + self._force_drift,
                np.broadcast_to(slow_w, self._force_bias.shape),
            ],
            axis=-1,
        )

    def substep(self, state: FleetState) -> None:
        """Latches the fixes that are true between the state seen last and this one, interpolated linearly."""
        before, gap = self._looked, state.time - self._looked.time
        while self._next_fix <= state.time + 1e-9:
            share = (self._next_fix - before.time) / gap if gap > 0.0 else 1.0
            self._latch(
                before.position_w + share * (state.position_w - before.position_w),
                before.velocity_w + share * (state.velocity_w - before.velocity_w),
            )
            # Rounded, so that sums of many periods do not drift.
            self._next_fix = round(self._next_fix + self._options.gps.period, 9)
        self._looked = state

    def sample(self, state: FleetState, due: BoolArray) -> tuple[ImuSample, GpsFix]:
        """Reads the sensors of the robots that are due.

        Args:
            state: True state now, which has been passed.
            due: Which robots sample, (B, n); what is returned for the others means nothing.
        """
        imu, fix = self._inertial(state), self._arrived(state.time, due)
        self._draw(due)
        last = self._read
        self._read = _Reading(
            time=np.where(due, state.time, last.time),
            heading=np.where(due, state.heading, last.heading),
            impulse_b=np.where(due[..., None], state.velocity_increment_b, last.impulse_b),
        )
        return imu, fix

    def _inertial(self, state: FleetState) -> ImuSample:
        last, heading, iron = self._read, state.heading, self._options.magnetometer
        period = state.time - last.time
        spread = np.maximum(period, 1e-9)  # the averages over no time are zero, and not used
        force_b = (state.velocity_increment_b - last.impulse_b) / spread[..., None]
        force_b = force_b + turned(rotation(-0.5 * (heading + last.heading)), self._slope_w)
        yaw_rate = (heading - last.heading) / spread
        distortion = iron.hard_iron * np.sin(heading + self._iron[..., 0])
        distortion = distortion + iron.soft_iron * np.sin(2.0 * heading + self._iron[..., 1])
        force_b = (1.0 + self._force_scale) * force_b + self._force_error
        yaw_rate = (1.0 + self._gyro_scale) * yaw_rate + self._gyro_error
        faulty = self._faults.samples
        sample = ImuSample(
            period=period,
            specific_force_b=faulty("accelerometer", force_b, state.time),
            yaw_rate=faulty("gyro", yaw_rate, state.time),
            magnetic_heading=wrap(faulty("magnetometer", heading + distortion + self._magnetic_error, state.time)),
        )
        # What a fault makes of this period's signals it makes of the next one's; where they are missing, laws and
        # filters go on with the last ones.
        self._felt_b = np.where(np.isfinite(sample.specific_force_b), sample.specific_force_b, self._felt_b)
        self._turning = np.where(np.isfinite(sample.yaw_rate), sample.yaw_rate, self._turning)
        self._force_fault, self._gyro_fault = self._felt_b - force_b, self._turning - yaw_rate
        return sample

    def _arrived(self, now: float, due: BoolArray) -> GpsFix:
        """Hands over the newest fix that has arrived, where it has not been handed over before."""
        gps = self._options.gps
        while self._under_way and self._under_way[0].true_at.flat[0] + gps.latency <= now + 1e-9:
            fix, old = self._under_way.popleft(), self._newest
            got = fix.received
            self._newest = _Fix(
                position_w=np.where(got[..., None], fix.position_w, old.position_w),
                velocity_w=np.where(got[..., None], fix.velocity_w, old.velocity_w),
                true_at=np.where(got, fix.true_at, old.true_at),
                received=old.received | got,
            )
        newest = self._newest
        self._newest = replace(newest, received=newest.received & ~due)
        return GpsFix(
            received=newest.received & due,
            position_w=newest.position_w,
            velocity_w=newest.velocity_w,
            age=now - newest.true_at - gps.stamp_error,
        )

    def _latch(self, position_w: Array, velocity_w: Array) -> None:
        """Makes a fix and sends it on its way."""
        gps, draw = self._options.gps, self._fix_draws.next()
        own, common = draw[:, :-1], draw[:, -1:]
        slow_w = math.sqrt(1.0 - gps.common) * self._slow_w + math.sqrt(gps.common) * self._common_w
        position_w, velocity_w, received = self._faults.fixes(
            position_w + slow_w + gps.position_noise * own[..., :2],
            velocity_w + self._slow_velocity_w + gps.velocity_noise * own[..., 2:4],
            self._next_fix,
        )
        true_at = np.full(received.shape, self._next_fix)
        self._under_way.append(_Fix(position_w=position_w, velocity_w=velocity_w, true_at=true_at, received=received))
        drift = gauss_markov.correlation(gps.period, gps.position_bias_time)
        self._slow_w = gauss_markov.following(self._slow_w, gps.position_bias, drift, own[..., 4:6])
        self._common_w = gauss_markov.following(self._common_w, gps.position_bias, drift, common[..., 4:6])
        drift = gauss_markov.correlation(gps.period, gps.velocity_bias_time)
        self._slow_velocity_w = gauss_markov.following(self._slow_velocity_w, gps.velocity_bias, drift, own[..., 6:8])

    def _switch_on(self, normal: Array) -> None:
        """Sets what stays the same and where what drifts begins, from standard normal numbers (B, n + 1, 22)."""
        own, common = normal[:, :-1], normal[:, -1:]
        gps, imu, ground = self._options.gps, self._options.imu, self._options.ground
        self._force_bias, self._gyro_bias = imu.acceleration_bias * own[..., :2], imu.yaw_rate_bias * own[..., 2]
        self._force_scale, self._gyro_scale = imu.acceleration_scale * own[..., 3:5], imu.yaw_rate_scale * own[..., 5]
        self._iron = math.pi * special.erf(own[..., 6:8] / math.sqrt(2.0))  # phases, uniform
        # One ground for all robots of a trial, level to the side that a uniform angle says.
        downhill = math.pi * special.erf(common[..., 8] / math.sqrt(2.0))
        self._slope_w = GRAVITY * math.sin(ground.slope) * np.stack([np.cos(downhill), np.sin(downhill)], axis=-1)
        self._force_drift, self._gyro_drift = imu.acceleration_drift * own[..., 9:11], imu.yaw_rate_drift * own[..., 11]
        self._tilt, self._motors = ground.unevenness * own[..., 12:14], self._options.magnetometer.motors * own[..., 14]
        self._slow_w = gps.position_bias * own[..., 15:17]
        self._common_w = gps.position_bias * common[..., 15:17]
        self._slow_velocity_w = gps.velocity_bias * own[..., 17:19]

    def _draw(self, due: BoolArray) -> None:
        """Draws the errors of the period that begins now, for the robots that are due."""
        imu, ground, magnetic = self._options.imu, self._options.ground, self._options.magnetometer
        normal, time = self._imu_draws.next(), self._period

        def drifted(value: Array, deviation: float, correlation_time: float, draw: Array) -> Array:
            rho = gauss_markov.correlation(time, correlation_time)
            moved = gauss_markov.following(value, deviation, rho, draw)
            return np.where(due if value.ndim == due.ndim else due[..., None], moved, value)

        tilt = drifted(self._tilt, ground.unevenness, ground.unevenness_time, normal[..., :2])
        leak = GRAVITY * self._mean_tilt.between(self._tilt, tilt, ground.unevenness, self._tilt_draws.next())
        self._tilt = tilt
        self._force_drift = drifted(
            self._force_drift, imu.acceleration_drift, imu.acceleration_drift_time, normal[..., 2:4]
        )
        self._gyro_drift = drifted(self._gyro_drift, imu.yaw_rate_drift, imu.yaw_rate_drift_time, normal[..., 4])
        self._motors = drifted(self._motors, magnetic.motors, magnetic.motors_time, normal[..., 5])
        white = normal[..., 6:8] * (imu.acceleration_density / math.sqrt(time))
        force = self._force_bias + self._force_drift + leak + white
        gyro = self._gyro_bias + self._gyro_drift + normal[..., 8] * (imu.yaw_rate_density / math.sqrt(time))
        self._force_error = np.where(due[..., None], force, self._force_error)
        self._gyro_error = np.where(due, gyro, self._gyro_error)
        self._magnetic_error = np.where(due, self._motors + magnetic.noise * normal[..., 9], self._magnetic_error)
