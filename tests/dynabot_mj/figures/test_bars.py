import matplotlib.pyplot as plt
import pytest

from dynabot_mj import study
from dynabot_mj.experiments.formation import compare
from dynabot_mj.figures import bars, style
from dynabot_mj.study import configuration


@pytest.fixture(scope="module")
def dataset():
    return study.run(configuration.build({}, trials=2, duration=14.0, estimators=["perfect", "coupled"]))


def test_table_iii_is_the_paper_beside_point_masses(dataset, tmp_path):
    figure = bars.table_iii(compare.compared(dataset))
    heights = [bar.get_height() for bar in figure.axes[0].patches]
    assert len(heights) == 4
    assert heights[0] == 33.0
    style.save(figure, tmp_path / "table.png")
    assert (tmp_path / "table.png").stat().st_size < 300_000


def test_outcomes_are_those_that_plants_are_compared_by(dataset):
    changed = dataset.copy(deep=True)
    changed.collision_footprint[:] = 0.0
    changed.collision_footprint[{"case": 3}] = [1.0, 0.0]
    figure = bars.outcomes(compare.compared(changed))
    assert figure.axes[2].get_title() == "trials in which hulls\noverlap [%]"
    assert [bar.get_height() for bar in figure.axes[2].patches] == [0.0, 0.0, 0.0, 50.0]
    plt.close(figure)
