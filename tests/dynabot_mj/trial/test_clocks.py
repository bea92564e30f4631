import numpy as np

from dynabot_mj.trial.clocks import Clocks


def test_calendar_merges_sampling_and_control_and_ends_with_the_run():
    clocks = Clocks(tick=0.001, sample_ticks=4, control_ticks=6, duration_ticks=15, phase=np.zeros(2, dtype=np.int64))
    assert list(clocks.events()) == [(0, 4), (4, 6), (6, 8), (8, 12), (12, 15)]
    assert clocks.due(8, (1, 2))[0].all()
    assert not clocks.due(8, (1, 2))[1].any()


def test_robots_may_have_clocks_of_their_own():
    clocks = Clocks(tick=0.001, sample_ticks=5, control_ticks=5, duration_ticks=10, phase=np.array([0, 2]))
    assert [now for now, _ in clocks.events()] == [0, 2, 5, 7]
    np.testing.assert_array_equal(clocks.due(7, (3, 2))[1], 3 * [[False, True]])
    assert not clocks.due(1, (3, 2))[1].any()
