import subprocess
import sys

import pytest

from dynabot_mj.estimation.coupled_ekf import CoupledEkf
from dynabot_mj.estimation.decoupled_ekf import DecoupledEkf
from dynabot_mj.estimation.gps_extrapolation import GpsExtrapolation
from dynabot_mj.estimation.robot_by_robot import RobotByRobot
from dynabot_mj.perception import estimators


@pytest.mark.parametrize(
    ("name", "kind"), [("gps", GpsExtrapolation), ("decoupled", DecoupledEkf), ("coupled", CoupledEkf)]
)
def test_names(name, kind):
    assert isinstance(estimators.build(name, (2, 3)).filter, kind)
    assert isinstance(estimators.build(name, (2, 3), implementation="filterpy").filter, RobotByRobot)


def test_only_estimators_with_all_ten_states_have_moments():
    for implementation in estimators.IMPLEMENTATIONS:
        have = [
            hasattr(estimators.build(name, (1,), implementation=implementation).filter, "moments")
            for name in ("gps", "decoupled", "coupled")
        ]
        assert have == [False, True, True]


def test_filterpy_is_not_imported_for_the_batched_filters():
    code = (
        "import sys; from dynabot_mj.perception import estimators; estimators.build('coupled', (2,)); "
        "sys.exit('filterpy' in sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
