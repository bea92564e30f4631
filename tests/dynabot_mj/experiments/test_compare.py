import json

import numpy as np
import pytest

from dynabot_mj import configuration, study
from dynabot_mj.experiments import compare, in_loop


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
        "diverged", "velocity", "estimate_error", "paper",
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


@pytest.fixture(scope="module")
def perceptions():
    return study.run(
        configuration.build(
            {"perception": ["gauss-markov", "filter", "fitted"]},
            trials=2,
            duration=2.0,
            estimators=["perfect", "decoupled"],
            plants=["particle", "rigid"],
        )
    )


def test_pairs_differ_in_the_plant_or_in_the_perception_alone(perceptions):
    pairs = {(one.a, one.b) for one in compare.paired(perceptions)}
    assert ("particle/perfect", "rigid/perfect") in pairs
    assert ("particle/filter/decoupled", "rigid/filter/decoupled") in pairs
    assert ("rigid/gauss-markov/decoupled", "rigid/filter/decoupled") in pairs
    # Three perceptions on two plants: three pairs of plants, and three of perceptions on each plant.
    assert len(pairs) == 1 + 3 + 2 * 3
    table = compare.markdown(perceptions)
    assert "| decoupled | particle/gauss-markov - particle/filter |" in table
    assert "truth (gauss-markov), estimate (filter), estimate (fitted)" in table


def test_errors_in_the_loop_are_measured_and_can_be_imitated(perceptions):
    by_case = {row.perception: row.estimate_error for row in compare.rows(perceptions) if row.plant == "rigid"}
    assert by_case[None] is None
    # Table II's 1.1 m is that of the planar distance; six robots' means over 2 s scatter by about 10 %.
    assert by_case["gauss-markov"].position_rms_m == pytest.approx(1.1 / np.sqrt(2.0), rel=0.3)
    assert by_case["gauss-markov"].heading_rms_deg is None
    assert by_case["filter"].heading_rms_deg > 0.5
    written = in_loop.fitted_toml(perceptions)
    setup = configuration.load(written, "the written table", trials=1, perception=["fitted"])
    deviation = np.sqrt(sum(one.deviation**2 for one in setup.fitted.decoupled.position))
    measured = next(row for row in compare.rows(perceptions) if row.perception == "filter")  # of the first plant
    assert deviation == pytest.approx(measured.estimate_error.position_rms_m, rel=0.1)


def test_a_study_without_filters_has_none_to_imitate(dataset):
    assert in_loop.fitted_toml(dataset) is None


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
    assert "| gps       | paper    |              | 27, 27        | 300, 150 | 68 ± 11" in table
    assert len({len(line) for line in rows[:7]}) == 1
    assert "Velocity of the dissipation: truth (perfect), truth (gauss-markov)." in table
    assert "nan" not in table
