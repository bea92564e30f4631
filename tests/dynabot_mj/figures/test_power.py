from dataclasses import replace

import matplotlib.pyplot as plt
import pytest

from dynabot_mj.common import intervals
from dynabot_mj.experiments.formation.measures import PAIRED
from dynabot_mj.experiments.formation.power import Need, Plan, Point, Request
from dynabot_mj.figures import power


@pytest.fixture
def plan():
    need = Need(origin="given", difference=0.25, discordant=0.4, raised=False, pairs=50, trials=50, power=None)
    return Plan(
        request=Request(a="a", b="b", measure="collision_footprint"),
        measure=next(one for one in PAIRED if one.name == "collision_footprint"),
        pilot_trials=40,
        estimate=intervals.Difference(difference=0.25, low=0.1, high=0.45, n=40, p=0.05),
        discordant=None,
        alpha=0.05,
        needs=[need],
        unpaired_trials=None,
        curve=[Point(trials=n, power=p, low=None, high=None) for n, p in ((12, 0.3), (50, 0.8), (100, 0.98))],
        variances=[],
    )


def drawn(plan):
    figure = power.power(plan)
    found = {line.get_label(): (list(line.get_xdata()), list(line.get_ydata())) for line in figure.axes[0].lines}
    shaded = len(figure.axes[0].collections)
    plt.close(figure)
    return found, shaded


def test_the_curve_meets_what_is_asked_for_at_the_number_that_is_told(plan):
    lines, shaded = drawn(plan)
    assert lines == {
        "a - b of +25.0 points": ([12, 50, 100], [0.3, 0.8, 0.98]),
        "power 0.8 at p below 0.05": ([0, 1], [0.8, 0.8]),
        "50 trials": ([50, 50], [0, 1]),
    }
    assert shaded == 0


def test_the_ends_of_the_pilots_interval_are_shown_as_far_as_they_are_in_view(plan):
    own, low = replace(plan.needs[0], origin="pilot"), replace(plan.needs[0], origin="low", trials=None)
    lines, _ = drawn(replace(plan, needs=[own, low, replace(own, origin="high", trials=20)]))
    assert lines["at the ends of its interval"] == ([20, 100], [0.8, 0.8])
    assert "a - b of +25.0 points, the pilot's own" in lines


def test_simulated_power_has_its_interval_and_a_number_that_is_not_told_no_line(plan):
    points = [replace(one, low=one.power - 0.01, high=one.power + 0.01) for one in plan.curve]
    lines, shaded = drawn(replace(plan, curve=points, needs=[replace(plan.needs[0], trials=None)]))
    assert shaded == 1
    assert not [name for name in lines if name.endswith("trials")]
