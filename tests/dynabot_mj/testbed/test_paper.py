import pytest

from dynabot_mj.testbed import paper


def test_rates_in_table_iii_are_those_whose_binomial_errors_the_paper_prints():
    # sqrt(p (1 - p) / 100) in percent: 15(4), 42(5), 58(5), 24(4).
    shares = [
        paper.TABLE_III["gps"].collision,
        paper.TABLE_III["gps"].completion,
        paper.TABLE_III["decoupled"].completion,
        paper.TABLE_III["coupled"].completion,
    ]
    errors = [round(100 * (p * (1 - p) / paper.TRIALS_TABLE_III) ** 0.5) for p in shares]
    assert errors == [4, 5, 5, 4]


def test_spacing_is_the_side_of_the_triangle_in_the_well():
    assert pytest.approx(3.0 * 3.0**0.5) == paper.SPACING
