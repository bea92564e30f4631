"""An estimator: one of the three filters, and the policy that is the same for all of them.

The filters know the equations. The policy is what a robot needs on the ground: it starts a filter at the first fix and
magnetic heading, keeps samples that are not finite away from it, believes after all what has been rejected for long
(the filter is wrong, not the sensor), tells how old the last believed fix is, and starts a filter again whose numbers
broke down.
"""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
import numpy.typing as npt

from dynabot_mj.estimation.arrays import Array, BoolArray
from dynabot_mj.estimation.kalman import Update
from dynabot_mj.estimation.measurements import Estimate, GpsFix, ImuSample
from dynabot_mj.estimation.parameters import DEFAULT, Parameters

Rows = npt.NDArray[np.intp] | slice  # which of a filter's robots are meant


_PAST = 32  # samples remembered, to reach back to the time of a fix


class Filter(Protocol):
    """The equations of one filter for M robots; samples are given for the rows that are meant, and are finite."""

    def begin(self, rows: Rows, fix: GpsFix, magnetic_heading: Array) -> None:
        """Starts with a first fix and magnetic heading."""
        ...

    def predict(self, rows: Rows, imu: ImuSample) -> None:
        """Carries the state over a sampling period."""
        ...

    def see_heading(self, rows: Rows, magnetic_heading: Array) -> Update:
        """Takes a magnetic heading; where it is NaN nothing changes."""
        ...

    def see_fix(self, rows: Rows, fix: GpsFix, force_b: Array) -> Sequence[Update]:
        """Takes a fix, in one update or several; the mean specific force since it was true reaches back to it."""
        ...

    def believe_heading(self, rows: Rows, magnetic_heading: Array) -> None:
        """Sets the heading to a magnetic heading and forgets what was believed; the velocity over ground stays."""
        ...

    def believe_fix(self, rows: Rows, fix: GpsFix) -> None:
        """Sets position and velocity to a fix and forgets what was believed."""
        ...

    def sound(self) -> BoolArray:
        """Tells where all numbers are finite and all variances positive, (M,)."""
        ...

    def beliefs(self) -> dict[str, Array]:
        """Returns the fields of `Estimate` that a filter knows, (M, ...)."""
        ...


class Estimator:
    """A filter and its policy, for robots in any arrangement of leading axes; `build_estimator` makes one.

    Example:
        >>> one = np.ones(1)  # a single robot, at rest at (5, 0)
        >>> imu = dy.ImuSample(
        ...     period=0.036 * one, specific_force_b=np.zeros((1, 2)), yaw_rate=0.0 * one, magnetic_heading=0.0 * one
        ... )
        >>> fix = dy.GpsFix(
        ...     received=one > 0, position_w=np.array([[5.0, 0.0]]), velocity_w=np.zeros((1, 2)), age=0.1 * one
        ... )
        >>> dy.build_estimator("decoupled", (1,)).step(imu, fix, due=one > 0).position_w
        array([[5., 0.]])
    """

    def __init__(self, filter: Filter, shape: tuple[int, ...], parameters: Parameters = DEFAULT) -> None:  # noqa: A002
        """Starts without a fix.

        Args:
            filter: Of as many robots as the shape holds.
            shape: Leading axes of the samples, e.g. (trials, robots).
            parameters: Of the policy; the filter has its own copy.
        """
        count = int(np.prod(shape))
        self.filter = filter
        # The latest updates by magnetic heading and fix, and the rows that they are of: for tests of consistency.
        self.heading_update: tuple[npt.NDArray[np.intp], Update] | None = None
        self.fix_updates: tuple[npt.NDArray[np.intp], Sequence[Update]] = (np.arange(0), ())
        self._shape, self._parameters = shape, parameters
        self._known = np.zeros(count, dtype=bool)
        self._fix_age = np.full(count, np.inf)
        self._restarts = np.zeros(count, dtype=np.int64)
        self._force_b, self._yaw_rate = np.zeros((count, 2)), np.zeros(count)
        # The latest samples of the accelerometers and the periods that they are of; zero for robots that were not due.
        self._past_force_b, self._past_period = np.zeros((_PAST, count, 2)), np.zeros((_PAST, count))
        # Time since the first of a row of rejected samples; negative where the last one was believed.
        self._fix_doubt, self._heading_doubt = np.full(count, -1.0), np.full(count, -1.0)

    def step(self, imu: ImuSample, fix: GpsFix, due: BoolArray) -> Estimate:
        """Takes the samples of the robots that are due.

        Args:
            imu: Inertial samples, each array with the estimator's leading axes.
            fix: The newest fixes that have arrived since the robot's last sample.
            due: Which robots sample, with the same axes; the others' samples are not looked at.

        Returns:
            What every robot believes.
        """
        rows = np.flatnonzero(due)
        self.fix_updates = (np.arange(0), ())
        if rows.size:
            imu, fix = self._guarded(imu, rows), _flat(fix).at(rows)
            self._elapse(rows, imu.period)
            usable = fix.received & np.isfinite(fix.position_w).all(-1) & np.isfinite(fix.velocity_w).all(-1)
            usable &= np.isfinite(fix.age)
            known = self._known[rows]
            if known.any():
                self._advance(rows[known], imu.at(known), fix.at(known), usable[known])
            starting = ~known & usable & np.isfinite(imu.magnetic_heading)
            if starting.any():
                self._begin(rows[starting], fix.at(starting), imu.magnetic_heading[starting])
            self._restart_broken()
        return self._estimate()

    def _advance(self, rows: npt.NDArray[np.intp], imu: ImuSample, fix: GpsFix, usable: BoolArray) -> None:
        """Predicts, then takes the magnetic heading, then the fix."""
        some = self._meant(rows)
        self.filter.predict(some, imu)
        update = self.filter.see_heading(some, imu.magnetic_heading)
        self.heading_update = (rows, update)
        seen = np.isfinite(imu.magnetic_heading)
        believed = self._judge(self._heading_doubt, rows, seen, update.accepted, self._parameters.bearing_patience)
        if believed.any():
            self.filter.believe_heading(rows[believed], imu.magnetic_heading[believed])
        if not usable.any():
            return
        fixed, its_fix = rows[usable], fix.at(usable)
        updates = self.filter.see_fix(self._meant(fixed), its_fix, self._force_since(fixed, its_fix.age))
        self.fix_updates = (fixed, updates)
        accepted = np.logical_and.reduce([one.accepted for one in updates])
        everything = np.ones(len(fixed), dtype=bool)
        believed = self._judge(self._fix_doubt, fixed, everything, accepted, self._parameters.fix_patience)
        if believed.any():
            self.filter.believe_fix(fixed[believed], its_fix.at(believed))
        trusted = accepted | believed
        self._fix_age[fixed[trusted]] = its_fix.age[trusted]

    def _begin(self, rows: npt.NDArray[np.intp], fix: GpsFix, magnetic_heading: Array) -> None:
        self.filter.begin(rows, fix, magnetic_heading)
        self._known[rows] = True
        self._fix_age[rows] = fix.age
        self._fix_doubt[rows] = self._heading_doubt[rows] = -1.0

    def _elapse(self, rows: npt.NDArray[np.intp], period: Array) -> None:
        self._fix_age[rows] += period
        for doubt in (self._fix_doubt, self._heading_doubt):
            doubt[rows] += np.where(doubt[rows] >= 0.0, period, 0.0)

    def _judge(
        self, doubt: Array, rows: npt.NDArray[np.intp], seen: BoolArray, accepted: BoolArray, patience: float
    ) -> BoolArray:
        """Keeps the time since samples began to be rejected; tells which rows have to believe them now."""
        since = doubt[rows]
        rejected = seen & ~accepted
        since = np.where(rejected, np.maximum(since, 0.0), np.where(seen, -1.0, since))
        believed = rejected & (since > patience)
        doubt[rows] = np.where(believed, -1.0, since)
        return believed

    def _restart_broken(self) -> None:
        broken = self._known & ~self.filter.sound()
        self._known &= ~broken
        self._restarts += broken
        self._fix_age[broken] = np.inf

    def _guarded(self, imu: ImuSample, rows: npt.NDArray[np.intp]) -> ImuSample:
        """Returns the samples of some rows; the last good ones stand for those that are not finite."""
        force_b, yaw_rate = imu.specific_force_b.reshape(-1, 2)[rows], imu.yaw_rate.reshape(-1)[rows]
        self._force_b[rows] = force_b = np.where(np.isfinite(force_b), force_b, self._force_b[rows])
        self._yaw_rate[rows] = yaw_rate = np.where(np.isfinite(yaw_rate), yaw_rate, self._yaw_rate[rows])
        period = imu.period.reshape(-1)[rows]
        self._past_force_b, self._past_period = np.roll(self._past_force_b, 1, 0), np.roll(self._past_period, 1, 0)
        self._past_period[0] = 0.0
        self._past_force_b[0, rows], self._past_period[0, rows] = force_b, period
        magnetic_heading = imu.magnetic_heading.reshape(-1)[rows]
        return ImuSample(
            period=period,
            specific_force_b=force_b,
            yaw_rate=yaw_rate,
            magnetic_heading=np.where(np.isfinite(magnetic_heading), magnetic_heading, np.nan),  # infinity has no angle
        )

    def _force_since(self, rows: npt.NDArray[np.intp], age: Array) -> Array:
        """Returns the mean specific force of the last `age` seconds, (M, 2); one sample's noise would be amplified."""
        period = self._past_period[:, rows]
        before = np.cumsum(period, axis=0) - period
        weight = np.clip(age - before, 1e-9 * (period > 0.0), period)
        weighted: Array = (weight[..., None] * self._past_force_b[:, rows]).sum(axis=0)
        return weighted / np.maximum(weight.sum(axis=0), 1e-12)[:, None]

    def _meant(self, rows: npt.NDArray[np.intp]) -> Rows:
        """Returns the rows as a slice where they are all: views are cheaper than copies."""
        return slice(None) if len(rows) == len(self._known) else rows

    def _estimate(self) -> Estimate:
        beliefs = {
            # Copies: a filter may go on with its arrays, what was believed stays.
            name: values.reshape(*self._shape, *values.shape[1:]).copy()
            for name, values in self.filter.beliefs().items()
        }
        return Estimate(
            **beliefs,
            known=self._known.reshape(self._shape).copy(),
            fix_age=self._fix_age.reshape(self._shape).copy(),
            restarts=self._restarts.reshape(self._shape).copy(),
        )


def _flat(fix: GpsFix) -> GpsFix:
    """Returns fixes with their leading axes made one."""
    return GpsFix(
        received=fix.received.reshape(-1),
        position_w=fix.position_w.reshape(-1, 2),
        velocity_w=fix.velocity_w.reshape(-1, 2),
        age=fix.age.reshape(-1),
    )
