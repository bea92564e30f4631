import signal

import pytest

from dynabot_mj.controllers import gains
from dynabot_mj.controllers.design import tuning


def test_ctrl_c_is_passed_on(problem):
    seen = []

    def interrupt(iteration, cost):
        seen.append(iteration)
        if iteration == 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        tuning.tune(problem, gains.load("first"), interrupt)
    assert seen[-1] <= 2


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_inside_the_solver_ends_the_tuning_and_is_passed_on(problem, number):
    """Compiled code would swallow what a handler raises, and go on with nonsense."""
    taken, seen = [], []
    before = signal.signal(number, lambda one, frame: taken.append(one))

    def interrupt(iteration, cost):
        seen.append(iteration)
        if iteration == 1:
            signal.raise_signal(number)
            assert not taken  # held back until the solver has stopped

    try:
        tuning.tune(problem, gains.load("first"), interrupt)
    finally:
        signal.signal(number, before)
    assert taken == [number]
    assert seen[-1] <= 2
