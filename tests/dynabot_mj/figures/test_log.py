import dataclasses

import matplotlib.pyplot as plt
import numpy as np
import pytest

from dynabot_mj.figures import log as log_figure


@pytest.mark.parametrize("judged", [True, False])
def test_each_estimator_is_drawn_in_a_column(replayed, driven, judged):
    if not judged:
        replayed = dataclasses.replace(replayed, log=dataclasses.replace(driven, position_w=None, heading=None))
    figure = log_figure.replay(replayed)
    axes = np.array(figure.axes).reshape(4, 3)
    assert [axis.get_title() for axis in axes[0]] == ["GPS", "decoupled EKF", "coupled EKF"]
    assert [axis.get_ylabel() for axis in axes[:, 0]] == (
        ["y [m]", "x error [m]", "y error [m]", "heading error [deg]"]
        if judged
        else ["y [m]", "position sigma [m]", "heading sigma [deg]", "fix age [s]"]
    )
    for row in axes:
        assert len({axis.get_ylim() for axis in row}) == 1
    plt.close(figure)
