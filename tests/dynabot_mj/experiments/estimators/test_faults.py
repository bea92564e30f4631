from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.estimation.parameters import DEFAULT
from dynabot_mj.experiments.estimators import faults, troubles

# Whose heading is learned again from bearings that iron draws off: it takes more than a lap to average that out.
HEADING_LOST = ("bearing off", "starts turned", "gyro frozen from rest")


@pytest.fixture(scope="module")
def report():
    return faults.run(2, runs=4)


def named(report, part, estimator):
    (found,) = (one for one in report.costs if part in one.fault and one.estimator == estimator)
    return found


def test_every_fault_is_judged_for_every_estimator(report):
    assert len(report.costs) == 3 * len(troubles.every())


def test_nothing_is_ever_not_finite_and_nobody_starts_again(report):
    assert all(one.not_finite == 0 for one in report.costs)
    assert all(one.restarts == 0 for one in report.costs)


def test_headings_recover_but_where_they_are_learned_again(report):
    for one in report.costs:
        if not one.fault.startswith(HEADING_LOST):
            assert one.heading_recovery_s is not None, (one.fault, one.estimator)


def test_one_missing_sample_costs_next_to_nothing(report):
    for one in report.costs:
        if one.fault.startswith("one NaN"):
            assert abs(one.excess_m.difference) < 0.1
            assert abs(one.heading_deg - one.unfaulted_heading_deg) < 0.5


def test_inertial_units_carry_over_an_outage(report):
    assert named(report, "outage", "gps").position_m > 10.0
    assert named(report, "outage", "decoupled").position_m < 5.0
    assert named(report, "outage", "coupled").position_m < 5.0


def test_gates_reject_a_short_jump_and_patience_ends_with_a_long_one(report):
    assert named(report, "jump of 15 m, 2 s", "gps").excess_m.difference > 10.0
    for estimator in ("decoupled", "coupled"):
        assert named(report, "jump of 15 m, 2 s", estimator).excess_m.difference < 1.0
        assert named(report, "jump of 15 m, 5 s", estimator).excess_m.difference > 10.0


def test_a_wrong_start_is_found_out(report):
    for estimator in ("gps", "decoupled", "coupled"):
        one = named(report, "ends at rest", estimator)
        assert one.worst_heading_deg > 160.0  # it did start wrong
        assert one.position_m < 4.0 if estimator == "gps" else one.position_m < 6.0


def test_errors_at_the_jump_of_the_bearing_are_like_elsewhere(report):
    for one in report.crossings:
        assert one.crossings >= 4
        assert one.near_heading_deg < 2.0 * one.far_heading_deg
        assert one.near_largest_heading_deg < 20.0


def test_recovery_is_that_of_the_runs_that_have_to_be_back():
    time = np.arange(0.0, 12.0, 0.5)
    unfaulted = np.full((len(time), 20), 0.5)
    error = unfaulted.copy()
    error[time < 3.0, 0] = 5.0
    error[time < 4.0, 1] = 5.0
    error[:, 2] = np.inf
    assert faults.recovery(unfaulted, unfaulted, 1.0, time, 2.0) == 0.0
    assert faults.recovery(error[:, :2], unfaulted[:, :2], 1.0, time, 2.0) == pytest.approx(2.0)
    # Of 20 runs one need not be back, of 19 it need.
    assert faults.recovery(error, unfaulted, 1.0, time, 2.0) == pytest.approx(2.0)
    assert faults.recovery(error[:, :19], unfaulted[:, :19], 1.0, time, 2.0) is None
    # An unfaulted error beyond the band is no fault's doing; one that is not known is.
    assert faults.recovery(5.0 + unfaulted, 5.0 + unfaulted, 1.0, time, 2.0) == 0.0
    assert faults.recovery(np.nan * error, unfaulted, 1.0, time, 2.0) is None


def test_a_fault_that_breaks_an_estimator_would_show(monkeypatch):
    """Of an estimator that never believes what it has rejected: one that starts turned stays so."""
    stubborn = replace(DEFAULT, fix_patience=np.inf, bearing_patience=np.inf)
    built = faults.estimators.build
    monkeypatch.setattr(faults.estimators, "build", lambda name, shape: built(name, shape, stubborn))
    (trouble,) = (one for one in troubles.every() if "ends at rest" in one.name)
    found = faults.run(2, runs=2, chosen=[trouble])
    assert named(found, "", "coupled").position_recovery_s is None


@pytest.mark.slow
def test_positions_recover_from_every_fault():
    report = faults.run(0)
    assert all(one.position_recovery_s is not None for one in report.costs)
    assert all(one.not_finite == one.restarts == 0 for one in report.costs)
