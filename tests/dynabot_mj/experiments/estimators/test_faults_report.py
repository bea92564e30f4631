import json
from dataclasses import replace

import pytest

from dynabot_mj.experiments.estimators import faults, faults_report, troubles


@pytest.fixture(scope="module")
def outcome():
    return faults.run(2, runs=2, chosen=troubles.every()[:1])


def test_document_has_the_faults(outcome):
    document = json.loads(json.dumps(faults_report.document(outcome), allow_nan=False))
    assert document["runs"] == 2
    assert {row["estimator"] for row in document["faults"]} == {"gps", "decoupled", "coupled"}
    assert [row["estimator"] for row in document["crossings"]] == ["gps", "decoupled", "coupled"]


def test_table_names_what_broke_down(outcome):
    text = faults_report.markdown(outcome)
    assert "| GPS outage, 5 s" in text
    assert "Estimates that were not finite: none. Restarts: none." in text
    broken = replace(outcome, costs=(replace(outcome.costs[0], restarts=3), *outcome.costs[1:]))
    assert "Restarts: 3 (GPS outage, 5 s, gps)." in faults_report.markdown(broken)
