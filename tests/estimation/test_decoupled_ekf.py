import numpy as np
import pytest

from dynabot_mj.estimation import motion
from dynabot_mj.estimation.decoupled_ekf import GROUPS, DecoupledEkf
from dynabot_mj.estimation.measurements import GpsFix, ImuSample
from dynabot_mj.estimation.parameters import DEFAULT

ALL = slice(None)
SWIFT = [2, 3, 6, 7]  # v_x, v_y, b_ax, b_ay among the ten states


def fix(position_w, velocity_w=(0.0, 0.0), age=0.1):
    return GpsFix(
        received=np.ones(1, dtype=bool),
        position_w=np.array([position_w]),
        velocity_w=np.array([velocity_w]),
        age=np.array([age]),
    )


@pytest.fixture
def started():
    found = DecoupledEkf(1)
    found.begin(ALL, fix((1.0, 2.0), (3.0, -1.0)), np.array([0.5]))
    return found


def test_groups_have_every_state_once():
    assert sorted(state for group in GROUPS for state in group) == sorted(motion.NAMES)


def test_velocity_and_heading_move_by_the_model_of_all_ten_states(started):
    """What the sub-filters write out for themselves are blocks of the whole model."""
    rng = np.random.default_rng(3)
    root = rng.standard_normal((4, 4))
    started.velocity[:] = rng.standard_normal((1, 4))
    started.velocity_covariance[:] = covariance = root @ root.T
    started.heading.state[:] = [[2.0, 0.02]]
    sample = ImuSample(
        period=np.array([0.15]),
        specific_force_b=np.array([[2.0, -3.0]]),
        yaw_rate=np.array([1.5]),
        magnetic_heading=np.zeros(1),
    )
    state, _ = started.moments()
    whole = motion.predict(state, sample, DEFAULT)
    started.predict(ALL, sample)
    after, _ = started.moments()
    np.testing.assert_allclose(after, whole.state, atol=1e-12)
    block = np.ix_([0], SWIFT, SWIFT)
    jacobian, noise = whole.jacobian[block][0], whole.noise[block][0]
    np.testing.assert_allclose(started.velocity_covariance[0], jacobian @ covariance @ jacobian.T + noise, atol=1e-12)


def test_the_siblings_uncertainty_widens_the_position(started):
    before = started.position_covariance[0, 0, 0, 0]
    started.heading.covariance[0] = 0.0
    started.velocity_covariance[0, :2, :2] = 0.04 * np.eye(2)
    sample = ImuSample(
        period=np.array([0.1]), specific_force_b=np.zeros((1, 2)), yaw_rate=np.zeros(1), magnetic_heading=np.zeros(1)
    )
    started.predict(ALL, sample)
    grown = started.position_covariance[0, 0, 0, 0] - before
    assert grown == pytest.approx(2.0 * 0.04 * DEFAULT.velocity_error_time * 0.1 + DEFAULT.position_density**2 * 0.1)


def test_both_components_of_a_position_are_rejected_together(started):
    before = started.position.copy(), started.position_covariance.copy()
    _, x, y = started.see_fix(ALL, fix((16.0, 2.0), (3.0, -1.0)), np.zeros((1, 2)))
    assert not x.accepted[0]
    assert not y.accepted[0]
    assert y.squared[0] < 1.0  # nothing was wrong with it
    np.testing.assert_array_equal(started.position, before[0])
    np.testing.assert_array_equal(started.position_covariance, before[1])


def test_moments_are_in_blocks(started):
    state, covariance = started.moments()
    np.testing.assert_allclose(state[0, :2], [1.3, 1.9])
    assert state[0, motion.HEADING] == 0.5
    assert covariance[0, 0, 8] == pytest.approx(-(DEFAULT.position_bias**2))
    for group in GROUPS:
        inside = [motion.NAMES.index(one) for one in group]
        outside = [index for index in range(10) if index not in inside]
        np.testing.assert_array_equal(covariance[0][np.ix_(inside, outside)], 0.0)
    assert np.linalg.eigvalsh(covariance[0]).min() > 0.0
