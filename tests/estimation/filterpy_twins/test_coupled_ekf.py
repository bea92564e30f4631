import numpy as np
import pytest

from dynabot_mj.estimation.filterpy_twins import CoupledEkf
from dynabot_mj.estimation.parameters import DEFAULT


@pytest.fixture
def started(fix):
    """Faces north, where it goes."""
    one = CoupledEkf()
    one.begin(fix, np.array(np.pi / 2.0))
    return one


def test_a_start_knows_what_a_fix_and_a_bearing_tell(started):
    state, covariance = started.moments()
    # 0.1 s on with 3 m/s, which is ahead; nothing is known of the biases.
    np.testing.assert_allclose(state, [10.0, 20.3, 3.0, 0.0, np.pi / 2.0, 0.0, 0.0, 0.0, 0.0, 0.0], atol=1e-12)
    p, slow = DEFAULT, DEFAULT.position_bias**2
    # The fix is the place and its slow error: what one has too much, the other has too little.
    np.testing.assert_allclose(covariance[np.ix_([0, 8], [0, 8])], [[p.position_noise**2 + slow, -slow], [-slow, slow]])
    variances = [p.velocity_noise**2] * 2 + [p.bearing_noise**2, p.yaw_rate_bias**2] + [p.acceleration_bias**2] * 2
    np.testing.assert_allclose(np.diagonal(covariance)[2:8], variances)
    np.testing.assert_array_equal(covariance, covariance.T)


def test_a_believed_bearing_turns_the_robot_and_not_its_way(started):
    started.believe_heading(np.array(0.0))
    state, _ = started.moments()
    np.testing.assert_allclose(state[2:5], [0.0, 3.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(started.beliefs()["velocity_w"], [0.0, 3.0], atol=1e-12)
