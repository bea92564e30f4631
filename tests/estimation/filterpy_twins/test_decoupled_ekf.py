from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.estimation.filterpy_twins import CoupledEkf, DecoupledEkf


@pytest.fixture
def started(fix):
    one = DecoupledEkf()
    one.begin(fix, np.array(0.4))
    return one


def test_it_starts_as_the_coupled_one_does(started, fix):
    coupled = CoupledEkf()
    coupled.begin(fix, np.array(0.4))
    for ours, theirs in zip(started.moments(), coupled.moments(), strict=True):
        np.testing.assert_allclose(ours, theirs, atol=1e-12)


def test_both_components_of_a_position_are_rejected_where_one_is_far_off(started, fix):
    before, _ = started.moments()
    jumped = replace(fix, position_w=fix.position_w + np.array([1000.0, 0.1]))
    velocity, *position = started.see_fix(jumped, np.zeros(2))
    after, _ = started.moments()
    assert [bool(one.accepted) for one in (velocity, *position)] == [True, False, False]
    assert position[1].innovation[0] == pytest.approx(0.1)  # which alone would have been believed
    np.testing.assert_array_equal(after[[0, 1, 8, 9]], before[[0, 1, 8, 9]])


def test_a_bearing_tells_the_heading_alone(started):
    before, _ = started.moments()
    started.see_heading(np.array(0.5))
    after, covariance = started.moments()
    # As uncertain as the belief, so half of 0.1 rad is taken; there are no covariances by which others would be moved.
    assert after[4] == pytest.approx(0.45)
    others = [0, 1, 2, 3, 6, 7, 8, 9]
    np.testing.assert_array_equal(after[others], before[others])
    assert not covariance[np.ix_([4, 5], others)].any()
