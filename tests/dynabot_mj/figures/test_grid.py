import pytest

from dynabot_mj.experiments.formation import grid as experiment
from dynabot_mj.figures import grid
from dynabot_mj.perception import methods
from dynabot_mj.study import campaign, dataset, execution, trial_chunks
from dynabot_mj.study.execution import Execution, Watch


@pytest.fixture(scope="module")
def found():
    tree = {"trials": 3, "duration": 35.0, "plants": ["particle"], "estimators": ["perfect", "decoupled"]}
    made = campaign.load({**tree, "grid": {"robots": [2, 3], "start.headings": ["random", "leader"]}}, "grid.toml")
    whole = dataset.whole(made, execution.execute(trial_chunks.chunks(made), Execution(), Watch()))
    return experiment.found(whole, made, shown=["arrival_s", "completion_common"])


def test_a_row_for_each_measure_a_column_for_each_value_and_a_line_for_each_case(found):
    figure = grid.grid(found)
    axes = figure.axes
    assert len(axes) == 4
    assert [axis.get_title() for axis in axes[:2]] == ["headings random", "headings leader"]
    assert [axes[0].get_ylabel(), axes[2].get_ylabel()] == ["arrival [s]", "band 1 m [%]"]
    lines = {line.get_label(): line for line in axes[0].lines if not line.get_label().startswith("_")}
    assert set(lines) == {"perfect", "gauss-markov, decoupled"}
    assert lines["perfect"].get_color() == methods.colour("perfect")
    (row,) = (
        one
        for one in found.rows
        if one.values == {"robots": 3, "headings": "random"} and one.row.estimator == "perfect"
    )
    assert lines["perfect"].get_ydata()[1] == row.row.measured["arrival_s"].mean
    assert [text.get_text() for text in axes[2].get_xticklabels()] == ["2", "3"]


def test_words_stand_side_by_side_and_numbers_to_scale():
    assert grid._places([2, 3, 6])[0] == {"2": 0.0, "3": 0.25, "6": 1.0}
    assert grid._places(["a", "b", "c"])[0] == {"a": 0.0, "b": 0.5, "c": 1.0}
    assert grid._places(["a"])[0] == {"a": 0.0}
