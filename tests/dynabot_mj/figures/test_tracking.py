import matplotlib.pyplot as plt
import numpy as np

from dynabot_mj.experiments.vehicle.parity import Parity
from dynabot_mj.figures import tracking


def test_parity_draws_both_models_and_tells_the_error_by_the_range():
    time = np.linspace(0.0, 2.0, 9)
    mujoco = np.column_stack([time, 10.0 * time])
    found = Parity(
        names=("launch", "corner 2 m/s, 10 rad/s"),
        end=np.array([1.0, 2.0]),
        time=time,
        signals=("speed [m/s]", "yaw rate [rad/s]"),
        mujoco=mujoco,
        planar=mujoco + np.array([0.1, 5.0]),  # of ranges of 2 and 20
    )
    figure = tracking.parity(found)
    assert [axis.get_ylabel() for axis in figure.axes] == ["speed\n[m/s]", "yaw rate\n[rad/s]"]
    told = [axis.texts[0].get_text() for axis in figure.axes]
    assert told == ["RMS 5.0 %\nof the range", "RMS 25.0 %\nof the range"]
    lines = {line.get_label(): line.get_ydata() for line in figure.axes[1].lines}
    np.testing.assert_array_equal(lines["MuJoCo"], mujoco[:, 1])
    np.testing.assert_array_equal(lines["planar model"], found.planar[:, 1])
    # Every manoeuvre is named in the middle of its time.
    assert [(text.xy[0], text.get_text()) for text in figure.axes[0].texts[1:]] == [
        (0.5, "launch"),
        (1.5, "corner\n2 m/s,\n10 rad/s"),
    ]
    plt.close(figure)
