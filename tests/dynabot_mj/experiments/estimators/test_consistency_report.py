import json

from dynabot_mj.experiments.estimators import consistency, consistency_report


def test_document_and_table_of_a_short_run(monkeypatch):
    monkeypatch.setattr(consistency, "DURATION", 18.0)
    found = consistency.run(0, runs=3)
    document = json.loads(json.dumps(consistency_report.document(found), allow_nan=False))
    assert {row["sensors"] for row in document["squares"]} == set(consistency.sensors())
    assert {row["estimator"] for row in document["whiteness"]} == set(consistency.EKFS)
    assert "Autocorrelation" in consistency_report.markdown(found)
    assert len(document["too_small"]) == len(document["errors"]) == len(found.cases)
