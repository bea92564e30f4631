import json

import pytest

from dynabot_mj import study
from dynabot_mj.experiments.formation import compare, compare_tables
from dynabot_mj.study import configuration


@pytest.fixture(scope="module")
def dataset():
    return study.run(configuration.build({}, trials=4, duration=14.0, estimators=["perfect", "gps"]))


def test_document_is_json_without_nan_and_with_the_keys_of_the_interface(dataset):
    document = json.loads(json.dumps(compare.document(compare.compared(dataset)), allow_nan=False))
    assert [row["plant"] for row in document["rows"]] == ["particle", "rigid"] * 2
    assert set(document["rows"][0]) >= {
        "plant", "perception", "estimator", "trials", "period_ms", "sample_period_ms", "alpha_h", "alpha_d",
        "arrival_s", "time_to_formation_s", "in_band_fraction", "settling_s", "restricted_settling_s",
        "top_speed_mps", "collision", "collision_footprint", "collision_hulls_per_min", "hull_contact", "completion",
        "completion_common", "overturned", "diverged", "velocity", "estimate_error", "paper",
    }  # fmt: skip
    assert document["rows"][0]["perception"] is None
    assert document["rows"][2]["perception"] == "gauss-markov"
    assert set(document["rows"][0]["collision"]) == {"rate", "low", "high", "k", "n"}
    assert document["rows"][1]["collision"] is None  # of a body
    restricted = {"mean", "low", "high", "horizon_s", "median", "without"}
    assert set(document["rows"][0]["settling_s"]) == {"mean", "sd", "n", "unsettled", "hulls"}
    assert set(document["rows"][0]["arrival_s"]) == {"mean", "sd", "n", "not_arrived", "restricted"}
    assert set(document["rows"][0]["arrival_s"]["restricted"]) == restricted
    assert set(document["rows"][0]["time_to_formation_s"]) == restricted
    assert set(document["rows"][0]["collision_hulls_per_min"]) == {"rate", "low", "high", "k", "minutes", "excluded"}
    assert set(document["paired"][0]) == {
        "factor", "a", "b", "metric", "difference", "low", "high", "n", "p", "p_holm", "median",
    }  # fmt: skip
    assert document["rows"][0]["paper"] == {"settling_s": 33.0, "collision": 0.0, "completion": 1.0}


def test_tables_line_up_and_show_the_paper_beside_what_reproduces_it(dataset):
    comparison = compare.compared(dataset)
    text = compare_tables.markdown(comparison)
    assert "nan" not in text
    assert "Velocity of the dissipation: truth (perfect), truth (gauss-markov)." in text
    for table in (compare_tables.table(comparison), compare_tables.reproduction(comparison)):
        lines = [line for line in table.markdown().splitlines() if line.startswith("| ")]
        assert len({len(line) for line in lines}) == 1
    assert "| gps       | paper    |              | 27       | 300, 150 | 68 ± 11" in text
    assert "particle - rigid" in text


def test_cases_that_are_too_short_to_arrive_are_told(dataset):
    line = compare.late(compare.compared(dataset))
    assert line.startswith("not arrived within 14 s: 100 % of particle/perfect, 100 % of rigid/perfect")
