from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from dynabot_mj.experiments.estimators import checks, consistency
from dynabot_mj.experiments.estimators.consistency import MATCHED
from dynabot_mj.experiments.estimators.consistency_bounds import LAGS

RUNS, SEED, DURATION = 24, 5, 60.0


@pytest.fixture(scope="module")
def drives():
    options, _ = consistency.sensors()["matched, no latency"]
    return checks.drive(options, RUNS, SEED, DURATION)


@pytest.fixture(scope="module")
def coupled(drives):
    return consistency.examine("matched", "coupled", drives, MATCHED)


def by_name(rows):
    return {(row.kind, row.of): row for row in rows}


def test_coupled_filter_is_consistent_with_matched_sensors(coupled):
    rows = by_name(coupled.squares)
    # Of eight squares judged at 99 %, two are outside by chance in 0.3 % of the cases.
    assert sum(row.verdict in ("too small", "too large") for row in rows.values()) <= 1
    assert rows["NEES", "all states"].verdict == rows["NIS", "fix"].verdict == "consistent"
    assert rows["NIS", "bearing"].verdict == "consistent"
    assert rows["NEES", "all states"].inside > 0.95
    assert rows["NIS", "fix"].inside > 0.95
    assert all(row.white for row in coupled.whiteness)


@pytest.mark.parametrize(("factor", "verdict"), [(0.5, "too small"), (2.0, "too large")])
def test_fix_noise_wrong_by_a_factor_of_two_shows(drives, factor, verdict):
    """R is the square of the deviations, so these are wrong by its root."""
    wrong = replace(
        MATCHED,
        position_noise=np.sqrt(factor) * MATCHED.position_noise,
        velocity_noise=np.sqrt(factor) * MATCHED.velocity_noise,
    )
    found = consistency.examine("matched", "coupled", drives, wrong)
    rows = by_name(found.squares)
    assert rows["NIS", "fix"].verdict == verdict
    assert rows["NIS", "fix"].inside < 0.5


def test_coloured_errors_show_in_the_heading_before_they_show_in_nis():
    options, parameters = consistency.sensors()["default"]
    drives = checks.drive(options, 8, SEED, 40.0)
    rows = by_name(consistency.examine("default", "coupled", drives, parameters).squares)
    assert rows["NIS", "fix"].mean < rows["NIS", "fix"].high
    assert rows["NIS", "bearing"].mean < rows["NIS", "bearing"].high
    assert rows["NEES", "phi"].mean > 5.0


def test_decoupled_filter_is_not_deceived(drives):
    """What it drops are covariances between groups: its parts' covariances are rather too large than too small."""
    rows = consistency.examine("matched", "decoupled", drives, MATCHED).squares
    assert {(row.kind, row.of) for row in rows} >= {("NEES", "X b_x"), ("NIS", "fix X"), ("NIS", "fix velocity")}
    assert sum(row.verdict == "too small" for row in rows) <= 1  # by chance, as above
    assert all(row.mean > 0.5 * row.components for row in rows)


def test_whiteness_counts_multiple_tests(coupled):
    for row in coupled.whiteness:
        tests = LAGS * row.components
        assert 2.0 * stats.norm.sf(row.bound * np.sqrt(row.samples)) == pytest.approx(0.01)
        assert 2.0 * stats.norm.sf(row.bound_of_all * np.sqrt(row.samples)) == pytest.approx(0.01 / tests)


@pytest.mark.slow
def test_full_check():
    found = {(case.sensors, case.estimator): case for case in consistency.run(3).cases}
    assert all(one.verdict == "consistent" for one in found["matched, no latency", "coupled"].squares)
    # Reaching back with the motion of now makes the velocity's covariance too small, which no innovation tells.
    late = found["matched, 0.15 s", "coupled"]
    assert "v_x v_y b_ax b_ay" in late.too_small("NEES")
    assert not late.too_small("NIS")
    assert not late.coloured
    default = found["default", "coupled"]
    assert "phi" in default.too_small("NEES")
    assert not default.too_small("NIS")
    assert default.coloured
