from types import SimpleNamespace

from dynabot_mj.common.intervals import Difference, MeanInterval
from dynabot_mj.experiments.vehicle import track_report


def test_what_is_common_to_all_formations_is_told_with_its_digits():
    row = SimpleNamespace(
        velocity_rms_mps=0.12345, position_rms_m=0.456, largest_yaw_path_rad=1.2345, largest_slip_mps=0.789
    )
    assert [float(cell) for cell in track_report._common(row)] == [0.123, 0.46, 1.23, 0.79]


def test_formations_are_told_beside_those_of_particles():
    row = SimpleNamespace(
        formation_s=MeanInterval(mean=40.0, low=39.0, high=41.0),
        particle_formation_s=MeanInterval(mean=38.0, low=37.0, high=39.0),
        formation_delay_s=Difference(difference=2.0, low=1.0, high=3.0, n=4, p=0.5),
    )
    assert track_report._formed(row) == ["40.0 [39.0, 41.0]", "38.0 [37.0, 39.0]", "2.00 [1.00, 3.00]"]
