import json

import numpy as np
import pytest

from dynabot_mj import configuration, study
from dynabot_mj.experiments import compare


@pytest.fixture(scope="module")
def dataset():
    return study.run(configuration.build({}, trials=4, duration=14.0, estimators=["perfect", "gps"]))


def test_document_is_json_without_nan_and_with_the_keys_of_the_interface(dataset):
    document = json.loads(json.dumps(compare.document(dataset), allow_nan=False))
    assert [row["plant"] for row in document["rows"]] == ["particle", "rigid"] * 2
    assert set(document["rows"][0]) == {
        "plant", "perception", "estimator", "trials", "period_ms", "sample_period_ms", "alpha_h", "alpha_d",
        "settling_s",
        "top_speed_mps", "collision", "collision_footprint", "hull_contact", "completion", "completion_common",
        "diverged", "paper",
    }  # fmt: skip
    assert document["rows"][0]["perception"] is None
    assert document["rows"][2]["perception"] == "gauss-markov"
    assert set(document["rows"][0]["collision"]) == {"rate", "low", "high", "k", "n"}
    assert set(document["rows"][0]["settling_s"]) == {"mean", "sd", "n", "unsettled"}
    assert document["rows"][0]["paper"] == {"settling_s": 33.0, "collision": 0.0, "completion": 1.0}


def test_paired_differences_are_particle_minus_rigid_on_the_same_trials(dataset):
    found = {(one.a, one.metric): one for one in compare.paired(dataset)}
    assert len(found) == 2 * len(compare.PAIRED_METRICS)
    one = found["particle/gauss-markov/gps", "top_speed_mps"]
    assert one.b == "rigid/gauss-markov/gps"
    by_hand = dataset.top_speed.sel(case=one.a) - dataset.top_speed.sel(case=one.b)
    assert one.difference == pytest.approx(float(by_hand.mean()))
    assert one.low <= one.difference <= one.high
    assert one.n == 4


def test_rows_leave_undefined_trials_out(dataset):
    changed = dataset.copy(deep=True)
    changed["settling"][0] = [30.0, np.nan, 34.0, np.nan]
    changed["settled"][0] = [1.0, 0.0, 1.0, np.nan]
    changed["collision"][0] = [0.0, 0.0, 0.0, 1.0]
    row = compare.rows(changed)[0]
    assert (row.settling_s.mean, row.settling_s.n) == (32.0, 2)
    assert (row.settling_s.unsettled.k, row.settling_s.unsettled.n) == (1, 3)
    assert (row.collision.k, row.collision.n) == (1, 4)


def test_table_lines_up_and_shows_the_paper_beside(dataset):
    table = compare.markdown(dataset)
    rows = [line for line in table.splitlines() if line.startswith("| ")]
    assert "| gps       | paper    | 27, 27        | 300, 150 | 68 ± 11" in table
    assert len({len(line) for line in rows[:7]}) == 1
    assert "nan" not in table
