"""The manoeuvres of the acceptance drive: motors commanded directly, from launch to head-on collision."""

import math
from dataclasses import dataclass, replace

import numpy as np

from dynabot_mj.controllers.vehicle import GRAVITY
from dynabot_mj.experiments.vehicle.proving_ground import TURNING, ProvingGround, Trace
from dynabot_mj.plants.scene import Conditions

FULL_SPEED, FULL_TORQUE = 200.0, 2.0  # more than the motors can do: wheel speed [rad/s], feed-forward [Nm]
ROLLING_SPEED = 5.0  # from which the vehicle brakes and coasts [m/s]
TURN_SPEEDS = (10.0, 20.0, 40.0)  # commanded wheel speeds of the turns in place [rad/s]
HEADINGS = 12  # initial ones, over a full turn
CORNER_SPEEDS = (1.0, 2.0, 3.0, 4.0, 6.0)  # forward [m/s]
CORNER_DIFFERENCES = (5.0, 10.0, 20.0)  # of the right and the left wheels' commands [rad/s]
SLIDES = ((4.0, 2.0, 3.0), (0.0, 3.0, 0.0), (3.0, -1.0, -6.0))  # ahead, to the left [m/s], yaw rate [rad/s]
GENTLE_SLOPES = (0.001, 0.002, 0.005, 0.01, 0.02)  # rise per metre
SLOPES = (0.1, 0.2, 0.3)  # on which the creep is reported
STEEP_SLOPES = (0.4, 0.5, 0.6, 0.7)
COLLISION_SPEED = 3.0  # of each of the two [m/s]
COLLISION_PHASES = 8  # of the physics steps at which the hulls meet
_LONGEST = 120.0  # manoeuvre, whatever the conditions [s]


@dataclass(frozen=True, kw_only=True)
class Drives:
    """The traces of all manoeuvres."""

    launch: Trace
    brake: Trace
    coast: Trace
    turns: dict[float, Trace]  # by signed command [rad/s]
    headings: list[Trace]
    corners: dict[tuple[float, float], Trace]
    slides: list[Trace]
    uphill: dict[float, Trace]  # by rise per metre
    across: dict[float, Trace]
    collisions: list[Trace]

    def all(self) -> list[Trace]:
        """Returns every trace."""
        single = [self.launch, self.brake, self.coast, *self.headings, *self.slides, *self.collisions]
        return single + [
            one for group in (self.turns, self.corners, self.uphill, self.across) for one in group.values()
        ]


def run(ground: ProvingGround, level: Conditions, timestep: float) -> Drives:
    """Runs all manoeuvres.

    Args:
        ground: The level one.
        level: Its conditions; slopes are as it is but for their rise.
        timestep: Of the physics [s].
    """
    vehicle, rolling = ground.robot.vehicle, (ROLLING_SPEED, 0.0, 0.0)
    # What motors and tyres can do says how long a manoeuvre has to be observed.
    force = min(4.0 * vehicle.torque_limit / vehicle.wheel_radius, vehicle.friction * vehicle.mass * GRAVITY)
    acceleration = force / vehicle.effective_mass
    no_load = vehicle.voltage / vehicle.torque_constant * vehicle.wheel_radius
    decay = vehicle.effective_mass * vehicle.wheel_radius**2 / (4.0 * max(vehicle.wheel_damping, 1e-9))
    turns = [sign * speed for speed in TURN_SPEEDS for sign in (1.0, -1.0)]
    angles = np.arange(HEADINGS) * math.tau / HEADINGS
    slopes = {
        slope: ProvingGround(replace(level, slope=slope), timestep)
        for slope in (*GENTLE_SLOPES, *SLOPES, *STEEP_SLOPES)
    }
    return Drives(
        launch=ground.run(min(_LONGEST, 5.0 * no_load / acceleration), FULL_SPEED, FULL_TORQUE),
        brake=ground.run(min(_LONGEST, 0.5 + 1.5 * ROLLING_SPEED / acceleration), 0.0, motion=rolling),
        coast=ground.run(min(_LONGEST, decay), None, motion=rolling),
        turns={speed: ground.run(3.0, speed * TURNING) for speed in turns},
        headings=[ground.run(2.0, TURN_SPEEDS[1] * TURNING, heading=float(angle)) for angle in angles],
        corners={
            (speed, difference): ground.run(
                6.0, speed / ground.rolling_radius + difference / 2.0 * TURNING, motion=(speed, 0.0, 0.0)
            )
            for speed in CORNER_SPEEDS
            for difference in CORNER_DIFFERENCES
        },
        slides=[ground.run(4.0, None, motion=motion) for motion in SLIDES],
        uphill={slope: one.run(2.0, 0.0) for slope, one in slopes.items()},
        across={slope: slopes[slope].run(2.0, 0.0, heading=math.pi / 2.0) for slope in SLOPES},
        collisions=_collide(ProvingGround(level, timestep, robots=2), timestep),
    )


def _collide(ground: ProvingGround, timestep: float) -> list[Trace]:
    """Drives two robots head-on, with the hulls meeting at different phases of a physics step."""
    traces = []
    for phase in range(COLLISION_PHASES):
        # Before a contact is seen, the hulls may already overlap by what they close in one step.
        apart = ground.robot.vehicle.length + 0.6 + phase / COLLISION_PHASES * 2.0 * COLLISION_SPEED * timestep
        traces.append(
            ground.run(
                1.0,
                COLLISION_SPEED / ground.rolling_radius,
                motion=(COLLISION_SPEED, 0.0, 0.0),
                heading=(0.0, math.pi),
                start=((-apart / 2.0, 0.0), (apart / 2.0, 0.0)),
                stop_at_contact=True,
            )
        )
    return traces
