import math

import pytest

from dynabot_mj.study.methods import Methods


@pytest.mark.parametrize(
    ("name", "alpha_h", "alpha_d", "uncertainty", "estimation_time"),
    [
        ("perfect", 650.0, 300.0, 0.0, 0.0),
        ("gps", 300.0, 150.0, 3.5, 5.9e-3),
        ("decoupled", 650.0, 300.0, 1.1, 13.8e-3),
        ("coupled", 500.0, 300.0, 0.7, 114.2e-3),
    ],
)
def test_rows_have_the_gains_of_table_iii_and_the_errors_and_times_of_table_ii(
    name, alpha_h, alpha_d, uncertainty, estimation_time
):
    row = getattr(Methods(), name)
    assert (row.alpha_h, row.alpha_d, row.uncertainty) == (alpha_h, alpha_d, uncertainty)
    assert row.estimation_time == estimation_time


def test_perfect_information_alone_has_a_period_of_its_own_and_no_limit():
    rows = Methods()
    assert (rows.perfect.sample_period, rows.perfect.force_limit) == (0.01, math.inf)
    for row in (rows.gps, rows.decoupled, rows.coupled):
        assert (row.sample_period, row.control_period, row.force_limit) == ("auto", "auto", 50.0)
