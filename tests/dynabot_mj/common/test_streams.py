import numpy as np

from dynabot_mj.common.streams import Draws, Purpose


def take(trials, block, count=40, purpose=Purpose.LATENCY, **options):
    draws = Draws(5, trials, purpose, (2, 3), block=block, **options)
    return np.array([draws.next().copy() for _ in range(count)])


def test_numbers_depend_on_neither_block_size_nor_company():
    for normal in (False, True):
        alone = take([7], block=3, normal=normal)
        together = take([3, 7, 11], block=16, normal=normal)
        np.testing.assert_array_equal(alone[:, 0], together[:, 1])


def test_trials_and_purposes_have_streams_of_their_own():
    one = take([0, 1], block=8)
    assert not np.isclose(one[:, 0], one[:, 1]).any()
    assert not np.isclose(one, take([0, 1], block=8, purpose=Purpose.LOSS)).any()
