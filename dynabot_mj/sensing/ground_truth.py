"""What vehicles really did, on a grid of times: what sensors measure and estimates are compared with."""

from dataclasses import dataclass, fields
from typing import Any

from dynabot_mj.common.arrays import Array
from dynabot_mj.plants.plant import FleetState


@dataclass(frozen=True, kw_only=True)
class GroundTruth:
    """Runs of one robot each, on a common, even grid of K times that begins at zero."""

    time: Array  # (K,) [s]
    position_w: Array  # (K, R, 2) of the robot's centre [m]
    velocity_w: Array  # (K, R, 2) [m/s]
    heading: Array  # (K, R) not wrapped [rad]
    yaw_rate: Array  # (K, R) [rad/s]
    velocity_increment_b: Array  # (K, R, 2) see `FleetState` [m/s]
    wheel_speed: Array | None = None  # (K, R, 4), order of `scene.WHEELS` [rad/s]; None: no wheels
    motor_current: Array | None = None  # (K, R, 4) [A]; None: no motors

    @property
    def runs(self) -> int:
        """R."""
        return self.heading.shape[1]

    @property
    def interval(self) -> float:
        """Between two times of the grid [s]."""
        return float(self.time[1] - self.time[0])

    def thinned(self, every: int) -> "GroundTruth":
        """Returns the times of the grid from the first one on, one in so many."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        chosen: dict[str, Any] = {name: None if value is None else value[::every] for name, value in values.items()}
        return GroundTruth(**chosen)

    def state(self, index: int) -> FleetState:
        """Returns the state at a time of the grid, as R trials of one robot."""
        return FleetState(
            time=float(self.time[index]),
            position_w=self.position_w[index][:, None],
            velocity_w=self.velocity_w[index][:, None],
            heading=self.heading[index][:, None],
            yaw_rate=self.yaw_rate[index][:, None],
            velocity_increment_b=self.velocity_increment_b[index][:, None],
        )
