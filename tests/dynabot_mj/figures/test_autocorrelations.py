import matplotlib.pyplot as plt
import numpy as np

from dynabot_mj import study
from dynabot_mj.figures import autocorrelations
from dynabot_mj.study import configuration


def test_a_panel_for_each_estimator_that_errs_begins_at_one():
    found = study.run(configuration.build({}, trials=2, duration=14.0, estimators=["perfect", "gps"]))
    figure = autocorrelations.errors(found)
    (axis,) = figure.axes
    drawn = [line for line in axis.lines if not line.get_label().startswith("_")]
    assert len(drawn) == 2  # one for each plant
    for line in drawn:
        lag, correlation = line.get_data()
        assert (lag[0], correlation[0]) == (0.0, 1.0)
        # tau = 0.08 s: after 0.5 s 0.2 % is left, and the scatter of 12 sequences of 14 s, each of some 14 / (2 tau)
        # independent values: 1 / sqrt(12 * 87) = 0.03.
        assert np.abs(correlation[(lag > 0.4) & (lag < 1.0)]).max() < 0.25
    plt.close(figure)


def test_robots_that_know_everything_have_no_errors():
    assert (
        autocorrelations.errors(study.run(configuration.build({}, trials=1, duration=14.0, estimators=["perfect"])))
        is None
    )
