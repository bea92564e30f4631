import json

import numpy as np
import pytest

from dynabot_mj import study
from dynabot_mj.experiments.formation import case_rows, compare, compare_tables, in_loop
from dynabot_mj.study import configuration


@pytest.fixture(scope="module")
def dataset():
    return study.run(configuration.build({}, trials=4, duration=14.0, estimators=["perfect", "gps"]))


def test_document_is_json_without_nan_and_with_the_keys_of_the_interface(dataset):
    document = json.loads(json.dumps(compare.document(compare.compared(dataset)), allow_nan=False))
    assert [row["plant"] for row in document["rows"]] == ["particle", "rigid"] * 2
    assert set(document["rows"][0]) == {
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


def test_bodies_on_a_slope_beside_point_masses_on_the_level_are_told():
    sloped = study.run(configuration.build({}, trials=1, duration=1.0, estimators=["gps"], slope=0.05))
    text = compare_tables.markdown(compare.compared(sloped))
    assert "Bodies drive on a slope of 0.05; point masses know no ground." in text


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


def test_errors_in_the_loop_are_measured_and_can_be_imitated(perceptions):
    by_case = {row.perception: row.estimate_error for row in case_rows.rows(perceptions) if row.plant == "rigid"}
    assert by_case[None] is None
    # Table II's 1.1 m is that of the planar distance; six robots' means over 2 s scatter by about 10 %.
    assert by_case["gauss-markov"].position_rms_m == pytest.approx(1.1 / np.sqrt(2.0), rel=0.3)
    assert by_case["gauss-markov"].heading_rms_deg is None
    assert by_case["filter"].heading_rms_deg > 0.5
    written = in_loop.fitted_toml(perceptions)
    setup = configuration.load(written, "the written table", trials=1, perception=["fitted"])
    assert setup.fitted.seed == perceptions.attrs["seed"]
    deviation = np.sqrt(sum(one.deviation**2 for one in setup.fitted.decoupled.position))
    measured = next(row for row in case_rows.rows(perceptions) if row.perception == "filter")  # of the first plant
    assert deviation == pytest.approx(measured.estimate_error.position_rms_m, rel=0.1)


def test_tables_of_several_perceptions_tell_interactions_and_equivalence(perceptions):
    text = compare_tables.markdown(compare.compared(perceptions))
    assert "| decoupled | particle/gauss-markov - particle/filter |" in text
    assert "truth (gauss-markov), estimate (filter), estimate (fitted)" in text
    assert "Does the body matter more with one perception?" in text
    assert "fitted on seed 0, this very one: judge it on another." in text


def test_a_study_without_filters_has_none_to_imitate(dataset):
    assert in_loop.fitted_toml(dataset) is None
