import pytest

from dynabot_mj import testbed


def test_rates_in_table_iii_are_those_whose_binomial_errors_the_paper_prints():
    # sqrt(p (1 - p) / 100) in percent: 15(4), 42(5), 58(5), 24(4).
    shares = [
        testbed.TABLE_III["gps"].collision,
        testbed.TABLE_III["gps"].completion,
        testbed.TABLE_III["decoupled"].completion,
        testbed.TABLE_III["coupled"].completion,
    ]
    errors = [round(100 * (p * (1 - p) / testbed.TRIALS_TABLE_III) ** 0.5) for p in shares]
    assert errors == [4, 5, 5, 4]


def test_spacing_is_the_side_of_the_triangle_in_the_well():
    assert pytest.approx(3.0 * 3.0**0.5) == testbed.SPACING
