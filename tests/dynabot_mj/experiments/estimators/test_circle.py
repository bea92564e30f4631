import json
import tomllib

import numpy as np
import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.estimation.parameters import DEFAULT
from dynabot_mj.experiments.estimators import circle, circle_report
from dynabot_mj.perception.estimators import NAMES
from dynabot_mj.sensing.options import matched
from dynabot_mj.testbed import paper

# Standard deviations over the runs (200 runs, seed 0), and how far a mean may be from the paper's figure.
SPREAD = {"gps": 0.34, "decoupled": 0.24, "coupled": 0.20}
TOLERANCE = {"kinematic": 0.12, "rigid": 0.25}


@pytest.fixture(scope="module")
def outcome():
    return circle.run(circle.request({}, runs=12))


def test_a_few_runs_give_table_ii(outcome):
    for row in circle_report.rows(outcome):
        # What 200 runs may be off by, and three standard errors of twelve.
        published = paper.TABLE_II[row.estimator].uncertainty
        allowed = TOLERANCE["kinematic"] * published + 3.0 * SPREAD[row.estimator] / np.sqrt(12)
        assert row.paper_m == published
        assert row.uncertainty_m.n == 12
        assert row.uncertainty_m.mean == pytest.approx(published, abs=allowed)
    # Were 90 % of the runs ordered, fewer than 8 of 12 would be in 4 of 1,000 such tests.
    assert circle_report.ordered(outcome).k >= 8


def test_the_best_fit_hides_a_part_of_the_true_error(outcome):
    for row in circle_report.rows(outcome):
        assert row.uncertainty_m.mean < row.true_error_m.mean
        assert row.rms_mean_removed_m.mean < row.rms_per_axis_m.mean < row.true_error_m.mean


def test_the_document_has_means_rates_and_plain_numbers(outcome):
    document = json.loads(json.dumps(circle_report.document(outcome), allow_nan=False))
    assert (document["runs"], document["plant"], document["path"]) == (12, "kinematic", "circle")
    assert [row["estimator"] for row in document["rows"]] == ["gps", "decoupled", "coupled"]
    for row in document["rows"]:
        means = {"uncertainty_m", "true_error_m", "nis", "rms_per_axis_m", "rms_mean_removed_m", "heading_rms_deg"}
        assert all(set(row[key]) == {"mean", "sd", "n"} for key in means)
        assert (row["nees"] is None) == (row["estimator"] == "gps")
        assert row["restarts"] == 0
    assert set(document["ordered_fraction"]) == {"rate", "low", "high", "k", "n"}
    text = circle_report.markdown(outcome)
    assert "| gps       | 3." in text
    assert "12 runs of 100 s, T_s = 36 ms, seed 0" in text


def test_filters_whose_assumptions_hold_are_consistent(outcome):
    asked = circle.CircleRequest(duration=50.0, runs=8, sensors=matched(DEFAULT))
    scores = circle.follow(asked, 0, 8).scores["coupled"]
    # Over 50 such runs of seed 1 the standard deviations are 2.1 and 0.21.
    assert scores.nees.mean() == pytest.approx(10.0, abs=3.0 * 2.1 / np.sqrt(8))
    assert scores.nis.mean() == pytest.approx(4.0, abs=3.0 * 0.21 / np.sqrt(8))
    # Iron and the gyro's scale are errors that they do not assume.
    assert outcome.scores["coupled"].nees.mean() > 2.0 * scores.nees.mean()


def test_filters_assume_what_the_request_says(outcome):
    tree = {"filter": {"bearing_noise": 10.0}}
    scores = circle.run(circle.request(tree, runs=2, duration=40.0)).scores
    for name in NAMES:  # whose headings are the gyro's alone, and turned by the first bearing's error
        assert scores[name].heading_rms.mean() != pytest.approx(outcome.scores[name].heading_rms[:2].mean(), rel=0.05)


@pytest.mark.parametrize("plant", circle.PLANTS)
def test_a_run_does_not_depend_on_those_beside_it(plant):
    asked = circle.request({}, duration=30.0, seed=5, plant=plant)
    together, alone = circle.follow(asked, 1, 3), circle.follow(asked, 3, 1)
    for name in NAMES:
        for key, values in vars(alone.scores[name]).items():
            np.testing.assert_allclose(values, vars(together.scores[name])[key][2:], rtol=1e-9, err_msg=key)


def test_chunks_change_no_result(monkeypatch):
    asked = circle.request({}, runs=3, duration=30.0)
    whole, told = circle_report.document(circle.run(asked)), []
    monkeypatch.setattr(circle, "CHUNK", 2)
    parts = circle_report.document(circle.run(asked, told.append))
    for one, other in zip(parts["rows"], whole["rows"], strict=True):
        assert one["uncertainty_m"] == pytest.approx(other["uncertainty_m"], rel=1e-9)
    assert parts["ordered_fraction"] == whole["ordered_fraction"]
    assert told == sorted(told)
    assert told[-1] == pytest.approx(1.0)


@pytest.mark.parametrize("path", ["figure-eight", "line"])
def test_the_other_paths_are_judged_by_their_own_shape(path):
    found = circle_report.rows(circle.run(circle.request({}, runs=2, duration=60.0, path=path)))
    gps, decoupled, coupled = (row.uncertainty_m.mean for row in found)
    assert gps > decoupled > coupled > 0.1
    assert gps < 5.0
    assert all(row.paper_m is None for row in found)


def test_a_request_survives_its_toml():
    tree = {
        "period": 0.156,
        "sensors": {"gps": {"latency": 0.02, "stamp_error": 0.0}, "faults": [{"kind": "jump", "size": 15.0}]},
    }
    asked = circle.request({**tree, "filter": {"velocity_noise": 0.5}}, runs=7)
    assert (asked.runs, asked.sensors.gps.latency, asked.sensors.faults[0].size) == (7, 0.02, 15.0)
    assert (asked.filter.velocity_noise, asked.filter.position_noise) == (0.5, DEFAULT.position_noise)
    assert circle.request(tomllib.loads(circle.dump(asked))) == asked


@pytest.mark.parametrize(
    ("tree", "what"),
    [
        ({"runs": 0}, "runs = 0: input should be greater than or equal to 1"),
        ({"duration": 20.0}, "duration = 20: input should be greater than or equal to 30 s"),
        ({"period": float("nan")}, "period"),
        ({"sensors": {"gps": {"noise": 1.0}}}, "unknown key sensors.gps.noise"),
        ({"sensors": {"imu": {"acceleration_bias": -1.0}}}, "sensors.imu.acceleration_bias = -1"),
        ({"sensors": {"gps": {"latency": 0.02}}}, "sensors.gps.stamp_error = 0.03 s given, it must not exceed"),
        ({"sensors": {"faults": [{"kind": "outage", "start": 5.0, "end": 5.0}]}}, "from 5 to 5 s given, it never acts"),
        ({"sensors": {"faults": [{"kind": "outage", "robots": [1]}]}}, "robot 1 given, there are the robots 0 to 0"),
        ({"filter": {"gate": 1.0}}, "filter.gate = 1 given, it must be between 0 and 1"),
        ({"filter": {"fix_patience": 0.0}}, "filter.fix_patience = 0 given, it must be positive and at most"),
        ({"filter": {"noise": 1.0}}, "unknown key filter.noise"),
        ({"plant": "rigid", "path": "line"}, "its tether allows: circle"),
        ({"plant": "rigid", "period": 0.05}, "multiple of 0.009 s"),
    ],
)
def test_what_is_not_allowed_is_told_in_one_line(tree, what):
    with pytest.raises(InputError, match=what) as caught:
        circle.request(tree)
    assert "\n" not in str(caught.value)


@pytest.mark.slow
@pytest.mark.parametrize(("plant", "runs"), [("kinematic", 200), ("rigid", 100)])
def test_table_ii(plant, runs):
    found = circle.run(circle.request({}, runs=runs, plant=plant))
    for row in circle_report.rows(found):
        assert row.uncertainty_m.mean == pytest.approx(row.paper_m, rel=TOLERANCE[plant])
    assert circle_report.ordered(found).rate >= 0.9
