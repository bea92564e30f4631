import json
from dataclasses import replace

import pytest

from dynabot_mj import cli
from dynabot_mj.experiments.vehicle import track
from dynabot_mj.experiments.vehicle.manoeuvres import KINDS

TASK = track._formation


def brief(*arguments):
    """A formation of 45 s instead of 80 s: with perfect information it is there after 34 s."""
    task = TASK(*arguments)
    return replace(task, setup=replace(task.setup, duration=45.0))


def test_the_report_has_every_law_on_every_kind_of_course(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(track, "PERIODS", ((0.036, "perfect"),))
    monkeypatch.setattr(track, "COMPARED_PERIODS", ())
    monkeypatch.setattr(track, "FRICTIONS", (0.5,))
    monkeypatch.setattr(track, "COURSES_PER_KIND", 1)
    monkeypatch.setattr(track, "COURSE_DURATION", 2.0)
    monkeypatch.setattr(track, "_formation", brief)
    assert cli.main(["track", "--trials", "1", "--workers", "1", "--out", str(tmp_path), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert [(one["laws"], one["kind"]) for one in document["courses"]] == [
        (laws.label, kind) for laws in track.LAWS for kind in KINDS
    ]
    assert all(one["velocity_rms_mps"] > 0.0 for one in document["courses"])
    (formation,), (slippery,) = document["formations"], document["frictions"]
    assert formation["laws"] == slippery["laws"] == track.TUNED.label
    assert slippery["friction"] == 0.5
    # The same trial, so the same particles.
    assert formation["particle_settling_s"] == slippery["particle_settling_s"]
    assert formation["settling_s"]["mean"] == pytest.approx(formation["particle_settling_s"]["mean"], rel=0.1)
    assert formation["formation_s"]["mean"] == pytest.approx(formation["particle_formation_s"]["mean"], rel=0.1)
    assert formation["formation_delay_s"]["difference"] == pytest.approx(
        formation["formation_s"]["mean"] - formation["particle_formation_s"]["mean"]
    )
    assert {"tracking.json", "tracking.md", "tracking.png"} <= {file.name for file in tmp_path.iterdir()}
