from types import SimpleNamespace

from dynabot_mj.common.intervals import MeanInterval
from dynabot_mj.experiments.vehicle import track_report


def test_what_is_common_to_all_formations_is_told_with_its_digits():
    row = SimpleNamespace(
        velocity_rms_mps=0.12345, position_rms_m=0.456, largest_yaw_path_rad=1.2345, largest_slip_mps=0.789
    )
    assert [float(cell) for cell in track_report._common(row)] == [0.123, 0.46, 1.2, 0.79]


def test_formations_are_told_beside_those_of_particles():
    times = [MeanInterval(mean=value, low=value - 1.0, high=value + 1.0) for value in (40.0, 38.0, 2.0)]
    row = SimpleNamespace(formation_s=times[0], particle_formation_s=times[1], formation_delay_s=times[2])
    assert [cell.split(" ")[0].lstrip("+") for cell in track_report._formed(row)] == ["40.0", "38.0", "2.0"]
