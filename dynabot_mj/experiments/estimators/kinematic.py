"""A vehicle that follows a path exactly: the fast stand-in for the one on a tether.

It stands still while the estimators settle, speeds up evenly, and keeps its speed on a circle, a figure of eight or a
straight line. Its heading is the path's tangent, so its specific force is (dv/dt, v r).

The figure of eight is the sine-generated curve that closes: its heading swings by A sin(2 pi s / L), A the first zero
of the Bessel function J_0, L such that its smallest radius is the circle's.
"""

from typing import Literal, get_args

import numpy as np
from scipy import integrate, special

from dynabot_mj.common.arrays import Array
from dynabot_mj.common.streams import Purpose, generators
from dynabot_mj.sensing.ground_truth import GroundTruth

PathName = Literal["circle", "figure-eight", "line"]
PATHS: tuple[PathName, ...] = get_args(PathName)

RADIUS = 7.0  # of the circle [m]
SPEED = 3.0  # [m/s]
ACCELERATION = 1.0  # from rest to that speed [m/s^2]
REST = 4.0  # at the beginning [s]

_FINE = 10  # steps of the integration in an interval of the grid


def follow(path: PathName, runs: int, seed: int, duration: float, interval: float, first: int = 0) -> GroundTruth:
    """Drives along a path, each run turned by an angle of its own.

    Args:
        path: Its shape.
        runs: R.
        seed: Of the angles.
        duration: With the rest at the beginning [s].
        interval: Of the grid [s].
        first: Number of the first run; what a run draws depends on the seed and its number alone.
    """
    count = round(duration / interval)
    fine = np.linspace(0.0, count * interval, count * _FINE + 1)
    speed = np.clip(ACCELERATION * (fine - REST), 0.0, SPEED)
    # Of a speed that rises evenly from REST on: exact, corners included.
    rising = np.clip(fine - REST, 0.0, SPEED / ACCELERATION)
    way = 0.5 * ACCELERATION * rising**2 + SPEED * np.maximum(fine - REST - SPEED / ACCELERATION, 0.0)
    heading, curvature = _tangent(path, way)

    def integral(rate: Array) -> Array:
        return integrate.cumulative_simpson(rate, x=fine, initial=0.0)[::_FINE]

    offset = np.stack([integral(speed * np.cos(heading)), integral(speed * np.sin(heading))], axis=-1)
    sideways = integral(speed**2 * curvature)
    heading, speed, curvature = heading[::_FINE], speed[::_FINE], curvature[::_FINE]
    start = np.array([2.0 * np.pi * g.random() for g in generators(seed, range(first, first + runs), Purpose.HEADING)])
    turned = heading[:, None] + start
    return GroundTruth(
        time=interval * np.arange(count + 1, dtype=np.float64),
        position_w=np.stack(
            [
                offset[:, :1] * np.cos(start) - offset[:, 1:] * np.sin(start),
                offset[:, :1] * np.sin(start) + offset[:, 1:] * np.cos(start),
            ],
            axis=-1,
        ),
        velocity_w=speed[:, None, None] * np.stack([np.cos(turned), np.sin(turned)], axis=-1),
        heading=turned,
        yaw_rate=np.broadcast_to((speed * curvature)[:, None], turned.shape),
        velocity_increment_b=np.broadcast_to(np.stack([speed, sideways], axis=-1)[:, None], (*turned.shape, 2)),
    )


def _tangent(path: PathName, way: Array) -> tuple[Array, Array]:
    """Returns heading [rad] and curvature [1/m] after some way [m]."""
    match path:
        case "circle":
            return way / RADIUS, np.full_like(way, 1.0 / RADIUS)
        case "line":
            return np.zeros_like(way), np.zeros_like(way)
        case "figure-eight":
            swing = float(special.jn_zeros(0, 1)[0])
            phase = way / (swing * RADIUS)
            return swing * np.sin(phase), np.cos(phase) / RADIUS
