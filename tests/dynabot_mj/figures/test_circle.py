import matplotlib.pyplot as plt
import numpy as np
import pytest

from dynabot_mj.figures import circle
from dynabot_mj.perception import methods
from dynabot_mj.perception.estimators import NAMES


def test_each_panel_tells_and_marks_the_farthest_point(circled):
    figure = circle.paths(circled)
    chunk = circled.example
    for axis, name in zip(figure.axes, NAMES, strict=True):
        farthest = chunk.scores[name].uncertainty[0]
        assert axis.get_title().endswith(f": {farthest:.2f} m")
        lines = {line.get_label(): line for line in axis.lines}
        drawn = np.column_stack(lines["estimated path"].get_data())
        np.testing.assert_array_equal(drawn, chunk.tracks[name].position_w[chunk.first :, 0])
        assert lines["estimated path"].get_color() == methods.colour(name)
        (mark,) = (line for line in axis.lines if line.get_color() == "#D00000" and line.get_marker() == "None")
        assert np.hypot(*np.ptp(mark.get_data(), axis=1)) == pytest.approx(farthest)
    plt.close(figure)


def test_errors_stand_in_one_scale_with_what_is_not_judged_shaded(circled):
    figure = circle.errors(circled)
    axes = np.array(figure.axes).reshape(3, 3)
    chunk = circled.example
    for column, name in zip(axes.T, NAMES, strict=True):
        known = chunk.tracks[name].known[:, 0]
        (line,) = (one for one in column[0].lines if one.get_label() == "error")
        wrong = (chunk.tracks[name].position_w - chunk.truth.position_w)[:, 0, 0]
        np.testing.assert_allclose(line.get_ydata()[known], wrong[known])
        assert np.isnan(line.get_ydata()[~known]).all()
        assert np.abs(wrong[known]).max() < axes[0, 0].get_ylim()[1]
    for row in axes:
        assert len({axis.get_ylim() for axis in row}) == 1
    plt.close(figure)
