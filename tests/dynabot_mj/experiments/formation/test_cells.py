from dataclasses import asdict

import pytest

from dynabot_mj.common import intervals
from dynabot_mj.experiments.formation import cells, summaries
from dynabot_mj.experiments.formation.summaries import ContactHazard, Settling
from dynabot_mj.testbed.paper import TABLE_III


def settling(*times, hulls=0):
    return Settling(**asdict(intervals.mean(times)), unsettled=intervals.share(0, len(times)), hulls=hulls)


def test_trials_left_out_of_a_hazard_stand_behind_it():
    found = asdict(intervals.hazard(0, 2.0))
    assert cells.hazard(ContactHazard(**found, excluded=0)) == "0.00 [0.00, 1.84]"
    assert cells.hazard(ContactHazard(**found, excluded=3)) == "0.00 [0.00, 1.84] (3)"


def test_how_far_from_the_paper_is_told_where_both_spread():
    # (60 - 68) / sqrt(2 / 2 + 11^2 / 100).
    assert cells.off(settling(59.0, 61.0), TABLE_III["gps"]) == "-5.4"
    assert cells.off(settling(60.0), TABLE_III["gps"]) == ""
    assert cells.off(settling(30.0, 31.0), TABLE_III["perfect"]) == ""


def test_settled_trials_are_counted_with_those_whose_hulls_overlapped():
    assert cells.settled(settling(59.0, 61.0), TABLE_III["gps"]) == "2"
    assert cells.settled(settling(59.0, 61.0, hulls=1), TABLE_III["gps"]) == "2 (1)"


@pytest.mark.parametrize(("estimator", "settled", "collided"), [("perfect", "33", "0"), ("gps", "68 ± 11", "15")])
def test_the_papers_values_have_its_digits(estimator, settled, collided):
    row = TABLE_III[estimator]
    assert cells.published(summaries.published_settling(row)) == settled
    assert cells.published(summaries.published_rate(row.collision)) == collided
    assert cells.rate_beside(None, row) == "-"
