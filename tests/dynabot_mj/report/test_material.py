import numpy as np
import pytest

from dynabot_mj import study
from dynabot_mj.report import contents, material
from dynabot_mj.study import configuration


@pytest.fixture(scope="module")
def brief():
    return study.run(configuration.build({}, trials=2, first_trial=3, duration=2.0, estimators=["perfect", "gps"]))


@pytest.fixture(scope="module")
def gathered(brief, small_report):
    shares = []
    found = material.gather(brief, {"command": "dynabot compare < x"}, "", shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)
    return found


@pytest.fixture(scope="module")
def made(gathered):
    return contents.build(gathered)


def test_the_first_trial_of_each_case_is_the_studys_own(brief, gathered):
    assert [one.case.label for one in gathered.recordings] == list(brief.case.values)
    for one in gathered.recordings:
        kept_w = brief.trajectory_w.sel(case=one.case.label).isel(recorded=0)
        np.testing.assert_array_equal(one.position_w, kept_w)
    assert gathered.recordings_note == "Trial 3 of seed 0, run again for this page."


def test_a_trial_that_no_longer_is_the_studys_own_is_told(brief, gathered, monkeypatch):
    other = brief.copy(deep=True)
    other.trajectory_w[1, 0, 5] += 0.01
    # Neither says whose the paths are.
    monkeypatch.setattr(material, "_clip", lambda recordings, progress: (gathered.clip, gathered.clip_note))
    monkeypatch.setattr(material.circle, "run", lambda asked, progress: gathered.circle)
    found = material.gather(other, {}, "", lambda share: None)
    assert "not the study's own any more" in found.recordings_note


def test_what_cannot_be_repeated_is_left_out_and_told(brief, gathered, monkeypatch):
    monkeypatch.setattr(material.circle, "run", lambda asked, progress: gathered.circle)
    found = material.gather(brief, {}, "the file of its gains has changed since the study", lambda share: None)
    assert found.recordings == []
    assert found.clip is None
    page = contents.build(found).html
    assert "There are no figures over time: the file of its gains has changed since the study." in page
    assert "Distances to the leader" not in page


def test_the_page_tells_where_it_comes_from(made, brief):
    page = made.html
    assert "dynabot compare &lt; x" in page
    assert "dynabot compare < x" not in page
    for part in ("Formation of 3 robots, 2 trials of 2 s, seed 0", brief.attrs["versions"], "first_trial = 3"):
        assert part in page


def test_the_same_study_is_the_same_page(gathered, made):
    assert contents.build(gathered) == made


def test_every_table_can_be_saved_from_the_page(made):
    assert set(made.tables) == {"cases.csv", "differences.csv", "trials.csv", "circle.csv"}
    for name in made.tables:
        assert f'download="{name}"' in made.html


def test_the_tether_has_the_studys_sensors_without_their_faults(monkeypatch):
    fault = {"kind": "outage", "start": 1.0, "end": 2.0, "robots": [2]}
    sensors = {"gps": {"latency": 0.05}, "faults": [fault]}
    setup = configuration.build({"sensors": sensors}, trials=1, duration=1.0, estimators=["gps"], plants=["particle"])
    asked = []
    monkeypatch.setattr(material.circle, "run", lambda request, progress: asked.append(request))
    material.gather(study.run(setup), {}, "nothing to repeat", lambda share: None)
    assert asked[0].sensors.gps.latency == 0.05
    assert asked[0].sensors.faults == ()
    assert asked[0].filter == setup.filter
