import numpy as np
import pytest

from dynabot_mj.estimation import gauss_markov


def sequence(sigma, rho, length, chains=4000, seed=0):
    normal = np.random.default_rng(seed).standard_normal((length, chains))
    errors = [gauss_markov.first(sigma, normal[0])]
    for w in normal[1:]:
        errors.append(gauss_markov.following(errors[-1], sigma, rho, w))
    return np.array(errors)


def test_variance_is_sigma_squared_from_the_first_sample_on():
    errors = sequence(sigma=0.7, rho=0.6, length=8)
    # The variance of N independent normal values has relative standard deviation sqrt(2 / N) = 0.0224; 4.5 of them
    # are exceeded with probability 7e-6 per sample.
    np.testing.assert_allclose(errors.var(axis=1), 0.49, rtol=4.5 * np.sqrt(2 / 4000))


@pytest.mark.parametrize("lag", [1, 2, 4])
def test_correlation_falls_with_the_lag_as_stated(lag):
    rho = gauss_markov.correlation(0.036, 0.08)
    errors = sequence(sigma=1.0, rho=rho, length=6, seed=1)
    measured = np.corrcoef(errors[0], errors[lag])[0, 1]
    # Fisher: atanh of a correlation of N pairs has standard deviation 1 / sqrt(N - 3).
    assert abs(np.arctanh(measured) - np.arctanh(rho**lag)) < 4.5 / np.sqrt(4000 - 3)


def test_correlation_of_the_periods_of_table_iii():
    assert gauss_markov.correlation(0.08, 0.08) == pytest.approx(np.exp(-1.0))
    assert gauss_markov.correlation(0.156, 0.08) < gauss_markov.correlation(0.027, 0.08) < 1.0


@pytest.mark.parametrize("period", [0.027, 0.156, 1.0])
def test_the_mean_over_a_period_has_the_variance_of_the_process_and_goes_with_its_ends(period):
    """Against the process in steps a hundred times as fine, whose mean it stands for."""
    tau, steps, chains = 0.3, 100, 4000
    rho = gauss_markov.correlation(period / steps, tau)
    fine = sequence(sigma=2.0, rho=rho, length=steps + 1, chains=chains, seed=2)
    exact = 0.5 * (fine[:-1] + fine[1:]).mean(axis=0)
    mean = gauss_markov.period_mean(period, tau)
    normal = np.random.default_rng(3).standard_normal(chains)
    ours = mean.between(fine[0], fine[-1], 2.0, normal)
    x = period / tau
    variance = 4.0 * 2.0 * (x - 1.0 + np.exp(-x)) / x**2
    # Relative standard deviation of a variance of N values: sqrt(2 / N); 4.5 of them.
    for values in (exact, ours):
        assert values.var() == pytest.approx(variance, rel=4.5 * np.sqrt(2 / chains))
    # What is left of the fine mean behind its expectation is uncorrelated with the ends, and of the stated size. The
    # sum over a hundred steps is short of the integral by x^2 / 12 / 100^2 of it, far less than the scatter.
    left = exact - mean.weight * (fine[0] + fine[-1])
    assert abs(np.corrcoef(left, fine[0] + fine[-1])[0, 1]) < 4.5 / np.sqrt(chains)
    assert left.std() == pytest.approx(2.0 * mean.deviation, rel=4.5 * np.sqrt(0.5 / chains))
