"""Filters of single robots, behind the protocol that the batched filters have."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from dynabot_mj.estimation.arrays import Array, BoolArray
from dynabot_mj.estimation.estimator import Rows
from dynabot_mj.estimation.kalman import Update
from dynabot_mj.estimation.measurements import GpsFix, ImuSample


class Robot(Protocol):
    """`dynabot_mj.estimation.estimator.Filter` for one robot: samples and results have no leading axes."""

    def begin(self, fix: GpsFix, magnetic_heading: Array) -> None:
        """Starts with a first fix and magnetic heading."""
        ...

    def predict(self, imu: ImuSample) -> None:
        """Carries the state over a sampling period."""
        ...

    def see_heading(self, magnetic_heading: Array) -> Update:
        """Takes a magnetic heading; where it is NaN nothing changes."""
        ...

    def see_fix(self, fix: GpsFix, force_b: Array) -> tuple[Update, ...]:
        """Takes a fix; the mean specific force since it was true reaches back to it."""
        ...

    def believe_heading(self, magnetic_heading: Array) -> None:
        """Sets the heading to a magnetic heading and forgets what was believed; the velocity over ground stays."""
        ...

    def believe_fix(self, fix: GpsFix) -> None:
        """Sets position and velocity to a fix and forgets what was believed."""
        ...

    def sound(self) -> bool:
        """Tells whether all numbers are finite and all variances positive."""
        ...

    def beliefs(self) -> dict[str, Array]:
        """Returns the fields of `Estimate` that a filter knows."""
        ...


class FullStateRobot(Robot, Protocol):
    """One that estimates all ten states."""

    def moments(self) -> tuple[Array, Array]:
        """Returns the states in the order of `dynabot_mj.estimation.motion`, (10,), and their covariance, (10, 10)."""
        ...


class RobotByRobot:
    """M robots with filters of their own: an `dynabot_mj.estimation.estimator.Filter`."""

    def __init__(self, robots: Sequence[Robot]) -> None:
        """Takes the robots."""
        self._robots = tuple(robots)

    def begin(self, rows: Rows, fix: GpsFix, magnetic_heading: Array) -> None:
        """Starts with a first fix and magnetic heading."""
        for index, robot in self._meant(rows):
            robot.begin(fix.at(index), magnetic_heading[index])

    def predict(self, rows: Rows, imu: ImuSample) -> None:
        """Carries the states over a period."""
        for index, robot in self._meant(rows):
            robot.predict(imu.at(index))

    def see_heading(self, rows: Rows, magnetic_heading: Array) -> Update:
        """Takes a magnetic heading."""
        return _stacked([robot.see_heading(magnetic_heading[index]) for index, robot in self._meant(rows)])

    def see_fix(self, rows: Rows, fix: GpsFix, force_b: Array) -> tuple[Update, ...]:
        """Takes a fix."""
        seen = [robot.see_fix(fix.at(index), force_b[index]) for index, robot in self._meant(rows)]
        return tuple(_stacked(updates) for updates in zip(*seen, strict=True))

    def believe_heading(self, rows: Rows, magnetic_heading: Array) -> None:
        """Sets the heading to a magnetic heading."""
        for index, robot in self._meant(rows):
            robot.believe_heading(magnetic_heading[index])

    def believe_fix(self, rows: Rows, fix: GpsFix) -> None:
        """Sets position and velocity to a fix."""
        for index, robot in self._meant(rows):
            robot.believe_fix(fix.at(index))

    def sound(self) -> BoolArray:
        """Tells where all numbers are finite and all variances positive."""
        return np.array([robot.sound() for robot in self._robots])

    def beliefs(self) -> dict[str, Array]:
        """Returns the fields of `Estimate`."""
        found = [robot.beliefs() for robot in self._robots]
        return {name: np.array([one[name] for one in found]) for name in found[0]}

    def _meant(self, rows: Rows) -> list[tuple[int, Robot]]:
        """Returns the robots of some rows, and where their samples are."""
        return [(index, self._robots[row]) for index, row in enumerate(np.arange(len(self._robots))[rows])]


class FullStateRobotByRobot(RobotByRobot):
    """The same of robots that estimate all ten states."""

    def __init__(self, robots: Sequence[FullStateRobot]) -> None:
        """Takes the robots."""
        super().__init__(robots)
        self._full = tuple(robots)

    def moments(self) -> tuple[Array, Array]:
        """Returns the states in the order of `motion.NAMES`, (M, 10), and their covariance, (M, 10, 10)."""
        states, covariances = zip(*[robot.moments() for robot in self._full], strict=True)
        return np.array(states), np.array(covariances)


def _stacked(updates: Sequence[Update]) -> Update:
    """Returns the updates of several robots as one."""
    return Update(
        state=np.array([one.state for one in updates]),
        covariance=np.array([one.covariance for one in updates]),
        innovation=np.array([one.innovation for one in updates]),
        innovation_covariance=np.array([one.innovation_covariance for one in updates]),
        squared=np.array([one.squared for one in updates]),
        accepted=np.array([one.accepted for one in updates]),
    )
