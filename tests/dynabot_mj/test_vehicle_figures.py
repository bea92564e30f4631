from dynabot_mj import figures, vehicle_figures
from dynabot_mj.experiments import drive


def test_the_drive_is_drawn_in_eight_panels(tmp_path):
    figure = vehicle_figures.acceptance_drive(drive.drive(timestep=0.005))
    assert len(figure.axes) == 8
    assert all(axis.get_xlabel() and axis.get_ylabel() and axis.get_title() for axis in figure.axes)
    figures.save(figure, tmp_path / "drive.png")
    assert (tmp_path / "drive.png").stat().st_size > 10_000
