import matplotlib.pyplot as plt
import numpy as np
import pytest

from dynabot_mj import study
from dynabot_mj.figures import paths, style
from dynabot_mj.study import configuration


@pytest.fixture(scope="module")
def dataset():
    return study.run(configuration.build({}, trials=2, duration=14.0, estimators=["perfect", "coupled"]))


def test_trajectories_show_both_plants_and_the_wells_rings(dataset):
    figure = paths.trajectories(dataset, "coupled", "gauss-markov")
    whole, near = figure.axes[:2], figure.axes[2:]
    assert [axis.get_title() for axis in whole] == ["point masses", "rigid bodies"]
    labels = [line.get_label() for line in near[0].lines]
    assert {"robot 1", "robot 2", "robot 3", "leader", "floor h0", "floor h0 + ε", "paper's Fig. 4, h0 ± ε/2"} <= set(
        labels
    )
    path = whole[1].lines[0]
    drawn = np.column_stack(path.get_data())
    np.testing.assert_array_equal(drawn, dataset.trajectory_w.sel(case="rigid/gauss-markov/coupled")[0, :, 0])
    radii = [np.hypot(*line.get_data())[0] for line in near[0].lines if "floor" in line.get_label()]
    assert radii == pytest.approx([3.0, 4.0])
    assert all(axis.get_xlabel() == "x [m]" for axis in figure.axes)
    plt.close(figure)


def test_the_same_figure_is_the_same_file(dataset, tmp_path):
    for name in ("a.png", "b.png"):
        style.save(paths.trajectories(dataset, "perfect", ""), tmp_path / name)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
