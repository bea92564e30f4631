"""What is told of an outcome; that of a dozen runs is told beside the runs themselves, in test_circle."""

from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.experiments.estimators import circle_report


@pytest.fixture
def told(circled):
    """Four runs with uncertainties of our own."""
    uncertainty = {
        "gps": [3.0, 3.0, 3.0, 4.0],
        "decoupled": [2.0, 1.0, np.nan, 2.0],
        "coupled": [1.0, 2.0, 1.0, 0.0],
    }
    scores = {name: replace(circled.scores[name], uncertainty=np.array(of)) for name, of in uncertainty.items()}
    return replace(circled, scores=scores)


def test_runs_are_ordered_where_all_three_estimators_have_an_uncertainty(told):
    found = circle_report.ordered(told)
    assert (found.k, found.n) == (2, 3)


def test_means_are_over_the_runs_that_have_one(told):
    rows = {row.estimator: row for row in circle_report.rows(told)}
    assert (rows["decoupled"].uncertainty_m.mean, rows["decoupled"].uncertainty_m.n) == (pytest.approx(5.0 / 3.0), 3)
    assert [rows[name].paper_m for name in ("gps", "decoupled", "coupled")] == [3.5, 1.1, 0.7]
    assert "| gps       | 3.25 ± 0.50     | 3.5 " in circle_report.markdown(told)


def test_the_paper_has_a_circle_alone_and_what_nobody_knows_is_a_dash(told):
    blind = {name: replace(one, uncertainty=np.full(4, np.nan)) for name, one in told.scores.items()}
    found = replace(told, request=replace(told.request, path="line"), scores=blind)
    assert all(row.paper_m is None and row.uncertainty_m.mean is None for row in circle_report.rows(found))
    assert "| gps       | -               | -         |" in circle_report.markdown(found)
    assert circle_report.ordered(found).rate is None
