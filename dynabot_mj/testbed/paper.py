"""Every number of the paper, once, with its place in it.

The paper is "Issues in Computational Resource Allocation in Cooperative Control". SI units throughout: its
milliseconds are seconds here, its percentages are fractions. What the paper does not say, and this project had to
choose to reproduce its results, is not here but among the defaults of `dynabot_mj.study.scenario`.
"""

import math
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class TaskTimes:
    """Execution times of the Dynabot's tasks (Table I and Sec. II)."""

    message: float  # t_m, to process one incoming message [s]
    sensors: float  # t_sd, to retrieve and convert the sensors' data [s]
    broadcast: float  # t_sb, to broadcast the state estimate [s]
    potential: float  # t_cp, per potential-field computation [s]
    gps: float  # t_g, to parse one GPS sentence [s]
    gps_period: float  # T_g, between two GPS sentences [s]


@dataclass(frozen=True, kw_only=True)
class EstimatorFigures:
    """One row of Table II."""

    uncertainty: float  # largest error between estimated and best-fit actual path [m]
    estimation_time: float  # t_se [s]


@dataclass(frozen=True, kw_only=True)
class TableIIIRow:
    """One row of Table III."""

    period: float  # T_c = T_s [s]
    alpha_h: float  # gain of the leader's potential [N m]
    alpha_d: float  # gain of the inter-robot potential (Sec. IV also calls it alpha_l) [N m]
    settling: float  # 1 % settling time, mean [s]
    settling_sd: float | None  # its standard deviation [s]
    collision: float  # share of trials that end in collision
    completion: float  # share of trials in which every robot settles within +-sigma of its goal


# Table I.
TASK_TIMES = TaskTimes(
    message=1.23e-3, sensors=8.86e-3, broadcast=3.40e-3, potential=0.7e-3, gps=32.0e-3, gps_period=0.2
)
UTILISATION_TABLE_I = 0.95
# Eq. 3 returns the periods of Table III with this bound, and not with the one that Table I gives.
UTILISATION_TABLE_III = 1.0

# Table II.
TABLE_II = {
    "gps": EstimatorFigures(uncertainty=3.5, estimation_time=5.9e-3),
    "decoupled": EstimatorFigures(uncertainty=1.1, estimation_time=13.8e-3),
    "coupled": EstimatorFigures(uncertainty=0.7, estimation_time=114.2e-3),
}

# Table III. The parentheses behind its rates are binomial standard errors of 100 trials, so they are not repeated here.
TABLE_III = {
    "perfect": TableIIIRow(
        period=0.010, alpha_h=650.0, alpha_d=300.0, settling=33.0, settling_sd=None, collision=0.0, completion=1.0
    ),
    "gps": TableIIIRow(
        period=0.027, alpha_h=300.0, alpha_d=150.0, settling=68.0, settling_sd=11.0, collision=0.15, completion=0.42
    ),
    "decoupled": TableIIIRow(
        period=0.036, alpha_h=650.0, alpha_d=300.0, settling=37.0, settling_sd=8.0, collision=0.0, completion=0.58
    ),
    "coupled": TableIIIRow(
        period=0.156, alpha_h=500.0, alpha_d=300.0, settling=41.0, settling_sd=4.0, collision=0.0, completion=0.24
    ),
}
TRIALS_TABLE_III = 100

# Sec. II: the vehicle and its fleet.
FLEET_SIZE = 7
TOP_SPEED = 10.0  # [m/s]
TOP_ACCELERATION = 0.5  # [g]

# Sec. III.A, Eqs. 4-7: the radio, fitted up to seven robots and 125 bytes.
RADIO_TICK = 6.5e-4  # t_k of Eq. 4 [s]
RADIO_MAX_BYTES = 125
RADIO_MAX_ROBOTS = 7

# Sec. IV: the formation experiment of Fig. 4.
ROBOTS = 3
WELL_RADIUS = 3.0  # h_0 [m]
WELL_WIDTH = 1.0  # epsilon [m]
SPACING = WELL_RADIUS * math.sqrt(3.0)  # d_0 [m]
START_DISTANCE = 50.0  # of the robots from the leader [m]
START_SPACING = 4.0  # between the robots [m]
TOP_SPEED_FORMATION = 3.7  # reached with perfect information [m/s]
SETTLING_SHARE = 0.01  # of the initial distance: "the time to reach 1 % of the steady-state position"
