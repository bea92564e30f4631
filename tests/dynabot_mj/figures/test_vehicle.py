from dynabot_mj.experiments.vehicle import drive
from dynabot_mj.figures import style, vehicle


def test_the_drive_is_drawn_in_eight_panels(tmp_path):
    figure = vehicle.acceptance_drive(drive.drive(timestep=0.005))
    assert len(figure.axes) == 8
    assert all(axis.get_xlabel() and axis.get_ylabel() and axis.get_title() for axis in figure.axes)
    style.save(figure, tmp_path / "drive.png")
    assert (tmp_path / "drive.png").stat().st_size > 10_000
