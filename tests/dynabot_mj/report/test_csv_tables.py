import csv
import io

import numpy as np
import pytest

from dynabot_mj import study
from dynabot_mj.experiments.estimators import circle
from dynabot_mj.experiments.formation import case_rows, compare
from dynabot_mj.report import csv_tables
from dynabot_mj.study import configuration


def read(text):
    return list(csv.DictReader(io.StringIO(text)))


def test_cases_are_the_rows_of_the_comparison(dataset):
    rows = read(csv_tables.of_study(compare.compared(dataset))["cases.csv"])
    expected = case_rows.rows(dataset)
    assert [row["plant"] for row in rows] == ["particle", "rigid"]
    for row, one in zip(rows, expected, strict=True):
        assert float(row["collision_footprint.high"]) == one.measured["collision_footprint"].high
        assert float(row["top_speed_mps.mean"]) == one.measured["top_speed_mps"].mean
        assert float(row["estimate_error.position_rms_m"]) == one.estimate_error.position_rms_m
    assert rows[0]["hull_contact.rate"] == ""  # undefined for point masses


def test_cases_without_errors_leave_their_columns_empty():
    setup = configuration.build({}, trials=1, duration=1.0, estimators=["perfect", "gps"], plants=["particle"])
    tables = csv_tables.of_study(compare.compared(study.run(setup)))
    perfect, gps = read(tables["cases.csv"])
    assert perfect["estimate_error.position_rms_m"] == ""
    assert float(gps["estimate_error.position_rms_m"]) > 0.0
    assert "estimate_error" not in perfect
    assert "differences.csv" not in tables


def test_trials_are_all_there_with_units(dataset):
    changed = dataset.copy(deep=True)
    changed.settling[{"case": 0, "trial": 1}] = np.nan
    rows = read(csv_tables.of_study(compare.compared(changed))["trials.csv"])
    assert len(rows) == 2 * 3
    assert rows[1]["settling [s]"] == ""
    speeds = [float(row["top_speed [m/s]"]) for row in rows]
    assert speeds == pytest.approx(dataset.top_speed.values.ravel().tolist(), abs=0.0)


def test_the_tethers_table_has_every_estimator():
    outcome = circle.run(circle.CircleRequest(runs=1, duration=30.0))
    rows = read(csv_tables.of_circle(outcome)["circle.csv"])
    assert [row["estimator"] for row in rows] == ["gps", "decoupled", "coupled"]
