"""Point masses under a sampled force: m dv/dt = F, solved exactly over each gap.

    v(t + s) = v + s F / m,        p(t + s) = p + s v + s^2 F / (2 m)

The dissipation is part of the sampled command F (Sec. IV commands "the gradient of the potential function plus a
velocity-dependent dissipative force"), so F is constant over the gap and no micro-steps are needed.

A point mass has no heading. For the footprint criterion, which both plants share, it gets one that turns toward its
velocity at 3 rad/s at most (the yaw-rate limit of the rigid robots' steering law) and stays while it barely moves.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.common.frames import to_body
from dynabot_mj.plants.plant import LONGEST_SUBSTEP, FleetState, NavigationError

_TOP_SPEED = 1e3  # beyond it the sampled loop has blown up: a hundred times what a Dynabot can do [m/s]
_HEADING_RATE = 3.0  # largest rate at which the heading follows the velocity [rad/s]
_HEADING_SPEED = 0.25  # below this speed the heading stays [m/s]


class ParticlePlant:
    """Point masses, one per robot.

    Example:
        >>> plant = dy.ParticlePlant(12.0, np.zeros((1, 3, 2)), np.zeros((1, 3)))  # 1 trial, 3 robots
        >>> states = plant.step(np.full((1, 3, 2), 6.0), 2.0)  # 6 N along each axis for 2 s
        >>> plant.state.position_w[0, 0]
        array([1., 1.])
    """

    def __init__(self, mass: float, position_w: Array, heading: Array) -> None:
        """Starts at rest.

        Args:
            mass: Of each robot [kg].
            position_w: Start positions, (B, n, 2) [m].
            heading: Start headings, (B, n) [rad].
        """
        self._mass = mass
        zero = np.zeros_like(position_w)
        self._state = FleetState(
            time=0.0,
            position_w=position_w.copy(),
            velocity_w=zero,
            heading=heading.copy(),
            yaw_rate=zero[..., 0],
            velocity_increment_b=zero,
        )
        self._diverged = np.zeros(len(position_w), dtype=bool)

    @property
    def state(self) -> FleetState:
        """The state now."""
        return self._state

    @property
    def diverged(self) -> BoolArray:
        """Trials whose sampled loop has blown up, (B,); their robots rest where they were before."""
        return self._diverged

    def step(self, force_w: Array, gap: float, error: NavigationError | None = None) -> Sequence[FleetState]:
        """Advances exactly; see `Plant.step`. There are no local laws that the error would mislead."""
        substeps = math.ceil(gap / LONGEST_SUBSTEP - 1e-9)
        start, states = self._state, []
        heading, impulse_b, interval = start.heading, start.velocity_increment_b, gap / substeps
        acceleration_w = force_w / self._mass
        slow = np.abs(start.velocity_w + gap * acceleration_w) < _TOP_SPEED  # not so where it is NaN
        self._diverged = self._diverged | ~slow.all(axis=(1, 2))
        gone = self._diverged[:, None, None]
        acceleration_w = np.where(gone, 0.0, acceleration_w)
        start = replace(start, velocity_w=np.where(gone, 0.0, start.velocity_w))
        for substep in range(1, substeps + 1):
            # Always from the gap's start, so that the substeps do not add rounding errors.
            s = interval * substep
            velocity_w = start.velocity_w + s * acceleration_w
            position_w = start.position_w + s * start.velocity_w + (0.5 * s * s) * acceleration_w
            turned = _follow(heading, velocity_w, interval)
            impulse_b = impulse_b + interval * to_body(acceleration_w, 0.5 * (heading + turned))
            states.append(
                FleetState(
                    # Rounded, so that sums of many gaps do not drift off the timer.
                    time=round(start.time + s, 9),
                    position_w=position_w,
                    velocity_w=velocity_w,
                    heading=turned,
                    yaw_rate=(turned - heading) / interval,
                    velocity_increment_b=impulse_b,
                )
            )
            heading = turned
        self._state = states[-1]
        return states


def _follow(heading: Array, velocity_w: Array, interval: float) -> Array:
    """Returns the heading after it turned toward the velocity, (B, n) [rad]."""
    vx, vy = velocity_w[..., 0], velocity_w[..., 1]
    error = (np.arctan2(vy, vx) - heading + np.pi) % (2.0 * np.pi) - np.pi
    most = _HEADING_RATE * interval
    moving = vx * vx + vy * vy >= _HEADING_SPEED**2
    return heading + np.where(moving, np.clip(error, -most, most), 0.0)
