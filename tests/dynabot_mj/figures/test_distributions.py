import matplotlib.pyplot as plt
import numpy as np
import pytest

from dynabot_mj import study
from dynabot_mj.experiments.formation import compare
from dynabot_mj.figures import distributions
from dynabot_mj.study import configuration


@pytest.fixture
def scored(dataset):
    """A study in which, of three point-mass trials, one forms and touches later, one touches first, one neither."""
    changed = dataset.copy(deep=True)
    particle = {"case": 0}
    changed.formation[particle] = [10.0, 5.0, np.nan]
    changed.contact[particle] = [12.0, 3.0, np.nan]
    changed.closest[particle] = [2.0, 1.0, 0.1]
    return changed


def test_formation_grows_from_below_and_contact_from_above(scored):
    figure = distributions.incidence(scored)
    contact, formation = figure.axes[0].lines[:2]
    assert formation.get_label() == "point masses: 1 form, 1 touch first"
    assert formation.get_xdata().tolist() == [0.0, 10.0, 14.0]
    assert formation.get_ydata().tolist() == pytest.approx([0.0, 1 / 3, 1 / 3])
    assert contact.get_xdata().tolist() == [0.0, 3.0, 14.0]
    assert contact.get_ydata().tolist() == pytest.approx([1.0, 2 / 3, 2 / 3])
    plt.close(figure)
    older = scored.drop_vars(["arrival", "formation", "in_band", "contact", "overturned"])
    assert distributions.incidence(older) is None


def test_smallest_distances_are_those_of_all_trials_and_tell_collisions(scored):
    figure = distributions.closest(scored)
    line = figure.axes[0].lines[0]
    assert line.get_label() == "point masses: 1 of 3 collide"
    assert line.get_xdata()[1:4].tolist() == [0.1, 1.0, 2.0]
    assert line.get_ydata()[1:4] == pytest.approx([1 / 3, 2 / 3, 1.0])
    plt.close(figure)


def test_differences_are_particle_minus_rigid_with_their_intervals(dataset):
    changed = dataset.copy(deep=True)
    changed.top_speed[:] = [[2.0, 3.0, 4.0], [1.0, 2.0, 3.0]]
    figure = distributions.differences(compare.compared(changed))
    titles = [axis.get_title() for axis in figure.axes]
    axis = figure.axes[titles.index("top speed [m/s]")]
    assert axis.lines[0].get_xdata() == [1.0]  # of three trials, without an interval
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == ["GPS"]
    plt.close(figure)


def test_one_plant_has_no_differences():
    alone = study.run(configuration.build({}, trials=1, duration=1.0, estimators=["gps"], plants=["particle"]))
    assert distributions.differences(compare.compared(alone)) is None
    for draw in (distributions.incidence, distributions.closest):  # too short to form
        plt.close(draw(alone))


def test_several_perceptions_have_colours_and_names_of_their_own():
    setup = configuration.build(
        {}, trials=1, duration=1.0, estimators=["gps"], plants=["particle"], perception=["gauss-markov", "fitted"]
    )
    figure = distributions.closest(study.run(setup))
    lines = figure.axes[0].lines
    assert [line.get_label().split(":")[0] for line in lines] == [
        "point masses, Gauss-Markov error",
        "point masses, fitted error",
    ]
    assert lines[0].get_color() != lines[1].get_color()
    plt.close(figure)
