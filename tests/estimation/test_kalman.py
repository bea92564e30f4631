import numpy as np
import pytest
from filterpy.kalman import KalmanFilter
from scipy import stats

from dynabot_mj.estimation import kalman


def problem(seed=0, rows=5, states=4, components=2):
    rng = np.random.default_rng(seed)
    root = rng.standard_normal((rows, states, states))
    noise_root = rng.standard_normal((rows, components, components))
    return {
        "state": rng.standard_normal((rows, states)),
        "covariance": root @ np.swapaxes(root, 1, 2) + 0.1 * np.eye(states),
        "innovation": rng.standard_normal((rows, components)),
        "observation": rng.standard_normal((rows, components, states)),
        "noise": noise_root @ np.swapaxes(noise_root, 1, 2) + 0.1 * np.eye(components),
    }


def test_update_is_the_textbook_one():
    given = problem()
    found = kalman.update(**given, gate=np.inf)
    for row in range(5):
        x, p, nu, h, r = (value[row] for value in given.values())
        s = h @ p @ h.T + r
        gain = p @ h.T @ np.linalg.inv(s)
        np.testing.assert_allclose(found.state[row], x + gain @ nu, rtol=1e-10)
        np.testing.assert_allclose(found.covariance[row], (np.eye(4) - gain @ h) @ p, atol=1e-10)
        np.testing.assert_allclose(found.innovation_covariance[row], s, rtol=1e-12)
        assert found.squared[row] == pytest.approx(nu @ np.linalg.solve(s, nu), rel=1e-10)
    assert found.accepted.all()


def test_update_is_filterpys():
    given = problem(seed=1)
    found = kalman.update(**given, gate=np.inf)
    for row in range(5):
        x, p, nu, h, r = (value[row] for value in given.values())
        other = KalmanFilter(dim_x=4, dim_z=2)
        other.x, other.P, other.H, other.R = x, p, h, r
        other.update(h @ x + nu)
        np.testing.assert_allclose(found.state[row], other.x, atol=1e-12)
        np.testing.assert_allclose(found.covariance[row], other.P, atol=1e-12)
        assert found.squared[row] == pytest.approx(other.mahalanobis**2)


@pytest.mark.parametrize("index", [0, 3])
def test_update_of_one_state_is_the_general_one(index):
    given = problem(seed=2, rows=40, components=1)
    observation = np.tile(np.eye(4)[index], (40, 1, 1))
    gate, nu = 1.0, 3.0 * given["innovation"]
    expected = kalman.update(given["state"], given["covariance"], nu, observation, np.array([[0.7]]), gate)
    found = kalman.update_one(given["state"], given["covariance"], nu[:, 0], index, 0.7, gate)
    assert 5 < found.accepted.sum() < 35  # both kinds are among them
    np.testing.assert_array_equal(found.accepted, expected.accepted)
    for name in ("state", "covariance", "innovation", "innovation_covariance", "squared"):
        np.testing.assert_allclose(getattr(found, name), getattr(expected, name), atol=1e-12)


def test_covariances_stay_symmetric_and_positive_where_the_short_form_fails():
    given = problem(seed=3, rows=200, components=4)
    given["covariance"] = given["covariance"] * 1e9
    given["noise"] = given["noise"] * 1e-6
    found = kalman.update(**given, gate=np.inf).covariance
    h, p = given["observation"], given["covariance"]
    s = h @ p @ np.swapaxes(h, 1, 2) + given["noise"]
    short = (np.eye(4) - p @ np.swapaxes(h, 1, 2) @ np.linalg.inv(s) @ h) @ p

    def asymmetry(matrix):
        return (np.abs(matrix - np.swapaxes(matrix, 1, 2)) / np.abs(matrix).max(axis=(1, 2), keepdims=True)).max()

    assert asymmetry(found) < 1e-12 < 1e-3 < asymmetry(short)
    assert np.linalg.eigvalsh(found).min() > 0.0 > np.linalg.eigvalsh(short).min()


def test_update_of_one_state_keeps_positive():
    given = problem(seed=4, rows=200)
    covariance = given["covariance"] * 1e9
    found = kalman.update_one(given["state"], covariance, np.zeros(200), 1, 1e-3, np.inf).covariance
    size = np.abs(found).max(axis=(1, 2), keepdims=True)
    assert (np.abs(found - np.swapaxes(found, 1, 2)) <= 1e-12 * size).all()
    assert (np.linalg.eigvalsh(found) > -1e-13 * size[:, 0]).all()
    assert (np.diagonal(found, axis1=1, axis2=2) > 0.0).all()


@pytest.mark.parametrize("components", [1, 2, 4])
def test_threshold_is_the_quantile_of_chi_square(components):
    assert kalman.threshold(0.9999, components) == pytest.approx(stats.chi2.ppf(0.9999, components))


@pytest.mark.parametrize(("factor", "believed"), [(0.999, True), (1.001, False)])
def test_gate_divides_at_its_value(factor, believed):
    given = problem(seed=5, rows=1)
    gate = 9.0
    squared = kalman.update(**given, gate=np.inf).squared[0]
    given["innovation"] = given["innovation"] * np.sqrt(gate * factor / squared)
    found = kalman.update(**given, gate=gate)
    assert found.accepted[0] == believed
    assert np.array_equal(found.state, given["state"]) != believed
    assert np.array_equal(found.covariance, given["covariance"]) != believed


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_innovations_that_are_not_finite_change_nothing(value):
    given = problem(seed=6)
    expected = kalman.update(**given, gate=np.inf)
    given["innovation"][2, 1] = value
    with np.errstate(invalid="ignore"):
        found = kalman.update(**given, gate=1e6)
    assert list(found.accepted) == [True, True, False, True, True]
    np.testing.assert_array_equal(found.state[2], given["state"][2])
    np.testing.assert_array_equal(found.covariance[2], given["covariance"][2])
    others = [0, 1, 3, 4]
    np.testing.assert_array_equal(found.state[others], expected.state[others])


def test_a_missing_sample_of_one_state_changes_nothing():
    given = problem(seed=7)
    found = kalman.update_one(given["state"], given["covariance"], np.array([0.1, np.nan, 0.1, 0.1, 0.1]), 0, 0.5, 9.0)
    assert list(found.accepted) == [True, False, True, True, True]
    np.testing.assert_array_equal(found.state[1], given["state"][1])
    np.testing.assert_array_equal(found.covariance[1], given["covariance"][1])


def test_propagation():
    given, rng = problem(seed=8), np.random.default_rng(8)
    jacobian, noise = rng.standard_normal((5, 4, 4)), rng.standard_normal((5, 4, 4))
    found = kalman.propagate(given["covariance"], jacobian, noise)
    np.testing.assert_allclose(found[3], jacobian[3] @ given["covariance"][3] @ jacobian[3].T + noise[3])
