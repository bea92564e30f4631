import subprocess
import sys

import pytest

from dynabot_mj.estimation import build
from dynabot_mj.estimation.coupled_ekf import CoupledEkf
from dynabot_mj.estimation.decoupled_ekf import DecoupledEkf
from dynabot_mj.estimation.gps_extrapolation import GpsExtrapolation
from dynabot_mj.estimation.robot_by_robot import RobotByRobot


@pytest.mark.parametrize(
    ("name", "kind"), [("gps", GpsExtrapolation), ("decoupled", DecoupledEkf), ("coupled", CoupledEkf)]
)
def test_names(name, kind):
    assert isinstance(build.build(name, (2, 3)).filter, kind)
    assert isinstance(build.build(name, (2, 3), implementation="filterpy").filter, RobotByRobot)


def test_only_estimators_with_all_ten_states_have_moments():
    have = [hasattr(build.build(name, (1,), implementation="filterpy").filter, "moments") for name in build.NAMES]
    assert have == [hasattr(build.build(name, (1,)).filter, "moments") for name in build.NAMES] == [False, True, True]


def test_filterpy_is_not_imported_for_the_batched_filters():
    code = "import sys; from estimation import build; build.build('coupled', (2,)); sys.exit('filterpy' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)
