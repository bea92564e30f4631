from dataclasses import replace

import matplotlib.pyplot as plt
import pytest

from dynabot_mj.common import intervals
from dynabot_mj.experiments.formation import case_rows
from dynabot_mj.experiments.formation.sensitivity import Found, Sensitivity
from dynabot_mj.figures import sensitivity
from dynabot_mj.perception import methods


def test_each_reading_has_a_line_and_each_estimator_a_mark_with_its_interval(dataset):
    row = case_rows.rows(dataset)[0]

    def of(name, contacts):
        collided = intervals.rate([1.0] * contacts + [0.0] * (4 - contacts))
        return replace(row, estimator=name, measured={**row.measured, "collision_footprint": collided})

    found = [
        Found(reading="as it is", duration_s=14.0, rows=[of("gps", 1), of("coupled", 2)], ranking={}),
        Found(reading="tau 0.3 s", duration_s=14.0, rows=[of("gps", 3), of("coupled", 4)], ranking={}),
    ]
    figure = sensitivity.sensitivity(Sensitivity(trials=3, robots=3, seed=0, found=found))
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == ["as it is", "tau 0.3 s"]
    hulls = figure.axes[2]
    marks = [line for line in hulls.lines if line.get_marker() == "o"]
    assert [line.get_xdata()[0] for line in marks] == [25.0, 50.0, 75.0, 100.0]
    assert [line.get_color() for line in marks[:2]] == [methods.colour("gps"), methods.colour("coupled")]
    # The second reading stands below the first, and its estimators beside each other.
    assert [round(line.get_ydata()[0]) for line in marks] == [0, 0, 1, 1]
    assert marks[0].get_ydata()[0] != marks[1].get_ydata()[0]
    one = intervals.rate([1.0, 0.0, 0.0, 0.0])
    assert hulls.lines[0].get_xdata() == pytest.approx([100.0 * one.low, 100.0 * one.high])
    plt.close(figure)
