"""What the three estimators assume of the sensors, and when they stop believing."""

from dataclasses import dataclass

import numpy as np

_DEGREE = float(np.pi / 180.0)


@dataclass(frozen=True, kw_only=True)
class Parameters:
    """Assumed errors. Densities are of white noise, whose mean over T seconds has the deviation density / sqrt(T)."""

    # GPS
    position_noise: float = 1.0  # white, per axis [m]
    position_bias: float = 0.75  # deviation of the slow error b_x, b_y, per axis [m]
    position_bias_time: float = 60.0  # its correlation time [s]
    velocity_noise: float = 0.12  # white, per axis [m/s]

    # Inertial unit; the accelerometer's density includes what tilting on uneven ground leaks of gravity.
    acceleration_density: float = 0.10  # [m/s^2/sqrt(Hz)]
    acceleration_bias: float = 0.09  # deviation of b_ax, b_ay [m/s^2]
    acceleration_bias_time: float = 20.0  # [s]
    yaw_rate_density: float = 0.095 * _DEGREE  # [rad/s/sqrt(Hz)]
    yaw_rate_bias: float = 0.5 * _DEGREE  # deviation of b_r when switched on [rad/s]
    yaw_rate_bias_walk: float = 0.007 * _DEGREE  # its random walk [rad/s/sqrt(s)]
    bearing_noise: float = (
        8.0 * _DEGREE
    )  # of the magnetic heading [rad]; iron and motors distort it slowly, which this has to cover

    position_density: float = 0.02  # what the motion model does not know, of the position [m/sqrt(s)]
    # The decoupled estimator's position filters take the velocity from their sibling. Its error is not white: its
    # correlation time is what turns its variance into a density of the position.
    velocity_error_time: float = 2.0  # tau_v [s]
    # What GPS extrapolation assumes of the accelerations that it does not measure.
    acceleration_unknown: float = 0.5  # [m/s^2]

    # Belief
    gate: float = 0.9999  # share of the innovations of a consistent filter that pass
    fix_patience: float = 3.0  # fixes rejected for so long are believed after all [s]
    bearing_patience: float = 1.0  # the same for magnetic headings [s]


DEFAULT = Parameters()
