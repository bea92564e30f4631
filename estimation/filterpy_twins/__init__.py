"""The same three filters on FilterPy's own Kalman filters, one robot at a time.

The batched filters write predict and update out for all robots at once; here FilterPy computes them, with dense
matrices. So these are what the batched filters are tested against, and what a filter costs on a robot.
"""

from dynabot_mj.estimation.filterpy_twins.coupled_ekf import CoupledEkf
from dynabot_mj.estimation.filterpy_twins.decoupled_ekf import DecoupledEkf
from dynabot_mj.estimation.filterpy_twins.gps_extrapolation import GpsExtrapolation

__all__ = ["CoupledEkf", "DecoupledEkf", "GpsExtrapolation"]
