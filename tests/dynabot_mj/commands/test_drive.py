import json

import pytest

from dynabot_mj import models


def test_drive_prints_one_json_document_and_writes_its_results(dynabot, tmp_path):
    done = dynabot("drive", "--json", "--out", tmp_path / "a")
    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout)
    assert 10.0 <= document["top_speed_mps"] <= 10.6
    assert 0.48 <= document["peak_acceleration_g"] <= 0.55
    assert set(document["turn_rate_over_theory"]) == {"10", "20", "40"}
    assert document["energy_gain_steps"] == 0
    assert {"airborne_fraction", "drift_mm_per_m", "heading_spread", "cornering", "collision"} < set(document)
    names = {file.name for file in (tmp_path / "a").iterdir() if not file.name.startswith(".")}
    assert names == {"drive.json", "drive.md", "drive.png"}
    assert json.loads((tmp_path / "a" / "drive.json").read_text()) == document


def test_drive_takes_another_ground_load_and_robot(main, tmp_path):
    robot = models.path("dynabot.xml").read_text(encoding="utf-8").replace('mass="0.6" euler', 'mass="1.2" euler')
    (tmp_path / "heavy.xml").write_text(robot, encoding="utf-8")
    options = ["--friction", 0.3, "--payload", 4, "--model", tmp_path / "heavy.xml"]
    done = main("drive", *options, "--out", tmp_path / "a")
    assert done.returncode == 0, done.stderr
    assert "18.4 kg, friction 0.3" in done.stdout
    assert "| top speed" in done.stdout
    assert "band" not in done.stdout  # the acceptance is of the robot as it is
    document = json.loads((tmp_path / "a" / "drive.json").read_text())
    assert document["peak_deceleration_g"] == pytest.approx(0.3, rel=0.05)
    assert document["payload_kg"] == 4.0
