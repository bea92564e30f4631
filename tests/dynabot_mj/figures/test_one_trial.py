from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pytest

from dynabot_mj.figures import one_trial
from dynabot_mj.study import configuration, scenario
from dynabot_mj.viewing import recording


@pytest.fixture(scope="module")
def recordings():
    """Two seconds of every case of two methods on both plants."""
    setup = configuration.build({}, trials=1, duration=2.0, estimators=["perfect", "gps"])
    return [
        recording.record(scenario.one_trial(setup, case.label, 0), 0.1, lambda share: None)
        for case in scenario.cases(setup)
    ]


@pytest.fixture
def drawn():
    figures = []
    yield figures.append
    for figure in figures:
        plt.close(figure)


def test_distances_are_those_of_the_robots_and_their_mean(recordings, drawn):
    figure = one_trial.distance(recordings)
    drawn(figure)
    titles = [axis.get_title(loc="left") for axis in figure.axes]
    assert titles == [
        "perfect information, point masses",
        "perfect information, rigid bodies",
        "GPS, point masses",
        "GPS, rigid bodies",
    ]
    lines = {line.get_label(): line.get_ydata() for line in figure.axes[3].lines}
    distances = np.linalg.norm(recordings[3].position_w, axis=-1)
    np.testing.assert_array_equal(lines["robot 2"], distances[:, 1])
    np.testing.assert_array_equal(lines["mean"], distances.mean(axis=-1))


def test_ages_are_those_between_different_robots(recordings, drawn):
    known = recordings[2]
    age = np.full_like(known.heard_age, 0.04)
    age[:, 0, 1] = 0.08
    age[:, [0, 1, 2], [0, 1, 2]] = 99.0  # its own is nobody's message
    age[:3] = np.nan
    figure = one_trial.message_age([replace(known, heard_age=age)])
    drawn(figure)
    mean = figure.axes[0].lines[0].get_ydata()
    np.testing.assert_allclose(mean, (5 * 40.0 + 80.0) / 6, rtol=1e-12)


def test_a_time_without_any_message_is_a_gap(recordings, drawn):
    silent = replace(recordings[2], heard_age=np.full_like(recordings[2].heard_age, np.nan))
    figure = one_trial.message_age([silent])
    drawn(figure)
    assert np.isnan(figure.axes[0].lines[0].get_ydata()).all()


def test_forces_have_a_running_mean_over_all_robots(recordings, drawn):
    steady = replace(recordings[0], force_w=np.full_like(recordings[0].force_w, [3.0, 4.0]))
    figure = one_trial.effort([steady])
    drawn(figure)
    lines = {line.get_label(): line.get_ydata() for line in figure.axes[0].lines}
    np.testing.assert_allclose(lines["mean over 2 s"], 5.0)
    np.testing.assert_allclose(lines["robot 3"], 5.0)


def test_slip_is_of_rigid_bodies_only(recordings, drawn):
    figure = one_trial.slip(recordings)
    drawn(figure)
    assert [axis.get_title(loc="left") for axis in figure.axes] == [
        "perfect information, rigid bodies",
        "GPS, rigid bodies",
    ]
    np.testing.assert_array_equal(figure.axes[1].lines[0].get_ydata(), recordings[3].slip[:, 0])
    assert one_trial.slip(recordings[:1]) is None


def test_errors_stand_within_the_bounds_that_were_believed(recordings, drawn):
    covariance = np.broadcast_to(np.diag([4.0, 9.0]), recordings[2].covariance.shape)
    believed_w = np.add(recordings[2].position_w, [0.5, 7.0])
    figure = one_trial.estimate_error([replace(recordings[2], believed_w=believed_w, covariance=covariance)])
    drawn(figure)
    np.testing.assert_allclose(figure.axes[0].lines[0].get_ydata(), 0.5)
    assert figure.axes[0].collections[0].get_datalim(figure.axes[0].transData).intervaly.tolist() == [-6.0, 6.0]
    assert one_trial.estimate_error(recordings[:2]) is None  # they know where they are
