import json

import pytest

from dynabot_mj.experiments.vehicle import drive, drive_figures, drive_report
from dynabot_mj.experiments.vehicle.drive_report import Line
from dynabot_mj.plants import scene


@pytest.fixture(scope="module")
def report():
    return drive.drive(timestep=0.005)


def test_a_line_holds_within_its_band():
    assert Line(name="a", value=1.0, unit="m", low=1.0, high=2.0).holds
    assert not Line(name="a", value=2.1, unit="m", low=1.0, high=2.0).holds
    assert not Line(name="a", value=None, unit="m", high=2.0).holds
    assert Line(name="a", value=0, unit="", high=0.0).holds
    assert not Line(name="a", value=1.0, unit="m").judged


def test_document_is_json_with_integers_for_counts(report):
    document = json.loads(json.dumps(drive_report.document(report), allow_nan=False))
    assert document["model"] == "dynabot"
    assert isinstance(document["energy_gain_steps"], int)
    assert isinstance(document["warnings"], int)
    assert document["acceptance"]["top speed"] is True


def test_markdown_shows_bands_of_the_robot_as_it_is_only(report):
    assert "| 10 to 10.6 " in drive_report.markdown(report)
    changed = drive.DriveReport(**{**vars(report), "conditions": scene.Conditions(payload=4.0)})
    assert "10 to 10.6" not in drive_report.markdown(changed)
    assert "acceptance" not in drive_report.document(changed)


def test_spreads_compare_steps_up_to_5_ms_only(report):
    other = drive_figures.Figures(**{**vars(report.figures), "top_speed_mps": report.figures.top_speed_mps * 1.02})
    assert drive_report.spreads({0.004: report.figures, 0.005: other})["top speed"] == pytest.approx(0.0198, abs=1e-4)
    assert drive_report.spreads({0.004: report.figures, 0.008: other})["top speed"] == 0.0
    table = drive_report.step_table({0.004: report.figures, 0.005: other})
    assert "| 4 ms " in table
    assert "1.98" in table
