import json

import pytest


def test_schedule_prints_one_json_document(dynabot):
    done = dynabot("schedule", "--json")
    assert done.returncode == 0
    document = json.loads(done.stdout)
    assert (document["robots"], document["utilisation"]) == (3, 1.0)
    rows = {row["estimator"]: row for row in document["rows"]}
    assert {name: row["period_ms"] for name, row in rows.items()} == {"gps": 27, "decoupled": 36, "coupled": 156}
    assert rows["coupled"]["period_exact_ms"] == pytest.approx(155.98, abs=0.005)
    # Judged before rounding: worth a word, not an error.
    assert "rounded periods of gps load the processor 1.0015" in done.stderr


@pytest.mark.parametrize("robots", range(2, 8))
def test_schedule_serves_every_fleet(main, robots):
    rows = json.loads(main("schedule", "--json", "--robots", robots).stdout)["rows"]
    assert rows[0]["period_ms"] < rows[1]["period_ms"] < rows[2]["period_ms"]
