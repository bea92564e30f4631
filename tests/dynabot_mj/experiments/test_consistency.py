import json
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from dynabot_mj.experiments import consistency, filter_checks
from dynabot_mj.experiments.consistency import MATCHED
from estimation.kalman import Update

RUNS, SEED, DURATION = 24, 5, 60.0


@pytest.fixture(scope="module")
def drives():
    options, _ = consistency.cases()["matched, no latency"]
    return filter_checks.drive(options, RUNS, SEED, DURATION)


@pytest.fixture(scope="module")
def coupled(drives):
    return consistency.watch("coupled", drives, MATCHED)


def by_name(rows):
    return {(row.kind, row.of): row for row in rows}


def test_coupled_filter_is_consistent_with_matched_sensors(coupled):
    rows = by_name(coupled.squares("matched"))
    # Of eight squares judged at 99 %, two are outside by chance in 0.3 % of the cases.
    assert sum(row.verdict != "consistent" for row in rows.values()) <= 1
    assert rows["NEES", "all states"].verdict == rows["NIS", "fix"].verdict == "consistent"
    assert rows["NIS", "bearing"].verdict == "consistent"
    assert rows["NEES", "all states"].inside > 0.95
    assert rows["NIS", "fix"].inside > 0.95
    assert all(row.white for row in coupled.whiteness("matched"))


@pytest.mark.parametrize(("factor", "verdict"), [(0.5, "too small"), (2.0, "too large")])
def test_fix_noise_wrong_by_a_factor_of_two_shows(drives, factor, verdict):
    """R is the square of the deviations, so these are wrong by its root."""
    wrong = replace(
        MATCHED,
        position_noise=np.sqrt(factor) * MATCHED.position_noise,
        velocity_noise=np.sqrt(factor) * MATCHED.velocity_noise,
    )
    found = consistency.watch("coupled", drives, wrong)
    rows = by_name(found.squares("matched"))
    assert rows["NIS", "fix"].verdict == verdict
    assert rows["NIS", "fix"].inside < 0.5


def test_coloured_errors_show_in_the_heading_before_they_show_in_nis():
    options, parameters = consistency.cases()["default"]
    rows = by_name(
        consistency.watch("coupled", filter_checks.drive(options, 8, SEED, 40.0), parameters).squares("default")
    )
    assert rows["NIS", "fix"].mean < rows["NIS", "fix"].high
    assert rows["NIS", "bearing"].mean < rows["NIS", "bearing"].high
    assert rows["NEES", "phi"].mean > 5.0


def test_decoupled_filter_is_not_deceived(drives):
    """What it drops are covariances between groups: its parts' covariances are rather too large than too small."""
    found = consistency.watch("decoupled", drives, MATCHED)
    rows = found.squares("matched")
    assert {(row.kind, row.of) for row in rows} >= {("NEES", "X b_x"), ("NIS", "fix X"), ("NIS", "fix velocity")}
    assert sum(row.verdict == "too small" for row in rows) <= 1  # by chance, as above
    assert all(row.mean > 0.5 * row.components for row in rows)


def test_bounds_hold_what_they_say():
    rng = np.random.default_rng(0)
    low, high = consistency.bounds(4, 64)
    means = rng.chisquare(4, (20_000, 64)).mean(axis=1)
    assert np.mean((means > low) & (means < high)) == pytest.approx(consistency.CONFIDENCE, abs=0.003)


def test_innovations_are_made_unit():
    rng = np.random.default_rng(0)
    root = np.array([[1.0, 0.0], [0.8, 0.3]])
    drawn = rng.standard_normal((4000, 2)) @ root.T
    update = Update(
        state=drawn,
        covariance=drawn,
        innovation=drawn,
        innovation_covariance=np.broadcast_to(root @ root.T, (4000, 2, 2)),
        squared=drawn[:, 0],
        accepted=np.ones(4000, dtype=bool),
    )
    np.testing.assert_allclose(np.cov(consistency.unit(update).T), np.eye(2), atol=0.08)


def test_autocorrelation_of_a_first_order_sequence():
    rng = np.random.default_rng(0)
    values = np.zeros((4000, 4, 1))
    for index in range(1, len(values)):
        values[index] = 0.8 * values[index - 1] + 0.6 * rng.standard_normal((4, 1))
    np.testing.assert_allclose(
        consistency.autocorrelation(values)[:, 0], 0.8 ** np.arange(1, consistency.LAGS + 1), atol=0.05
    )


def test_whiteness_counts_multiple_tests(coupled):
    for row in coupled.whiteness("matched"):
        tests = consistency.LAGS * row.components
        assert 2.0 * stats.norm.sf(row.bound * np.sqrt(row.samples)) == pytest.approx(0.01)
        assert 2.0 * stats.norm.sf(row.bound_of_all * np.sqrt(row.samples)) == pytest.approx(0.01 / tests)


def test_document_and_table_of_a_short_run(monkeypatch):
    monkeypatch.setattr(consistency, "_DURATION", 18.0)
    found = consistency.run(0, runs=3)
    document = json.loads(json.dumps(consistency.document(found), allow_nan=False))
    assert {row["sensors"] for row in document["squares"]} == set(consistency.cases())
    assert {row["estimator"] for row in document["whiteness"]} == set(consistency.EKFS)
    assert "Autocorrelation" in consistency.markdown(found)


@pytest.mark.slow
def test_full_check():
    found = consistency.run(3)
    matched = [one for one in found.squares if (one.sensors, one.estimator) == ("matched, no latency", "coupled")]
    assert all(one.verdict == "consistent" for one in matched)
    # Reaching back with the motion of now makes the velocity's covariance too small, which no innovation tells.
    late = next(one for one in found.deceived if (one.sensors, one.estimator) == ("matched, 0.15 s", "coupled"))
    assert "v_x v_y b_ax b_ay" in late.states
    assert not late.innovations
    assert not late.coloured
    default = next(one for one in found.deceived if (one.sensors, one.estimator) == ("default", "coupled"))
    assert "phi" in default.states
    assert not default.innovations
    assert default.coloured
