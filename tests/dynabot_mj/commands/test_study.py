import json
import os
import random
import signal
import time

import pytest

from dynabot_mj import study

GRID = """\
trials = 3
duration = 14.0
plants = ["particle"]
estimators = ["gps", "perfect"]

[grid]
robots = [2, 3]
radio.message_bytes = [40, 125]
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "grid.toml").write_text(GRID)
    return tmp_path


def test_study_writes_what_can_be_fed_back_in(main, folder):
    done = main("study", "grid.toml", "--workers", "1", "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    document, place = json.loads(done.stdout), folder / "out" / "study"
    assert len(document["rows"]) == 8
    assert {file.name for file in place.iterdir()} == {
        ".results", "study.nc", "study.toml", "execution.json", "table.md", "campaign.json", "campaign.png",
    }  # fmt: skip
    assert study.load(place / "study.nc").sel(robots=3).sizes["case"] == 4
    again = main("study", place / "study.toml", "--workers", "1", "--out", "again", cwd=folder)
    assert again.returncode == 0, again.stderr
    assert (folder / "again" / "study.nc").read_bytes() == (place / "study.nc").read_bytes()
    resumed = main("study", "grid.toml", "--workers", "1", "--json", "--resume", cwd=folder)
    assert resumed.returncode == 0
    assert json.loads(resumed.stdout)["rows"] == document["rows"]


def test_any_trial_of_it_can_be_repeated(main, folder):
    label = "particle/gauss-markov/gps/robots=3/message_bytes=40"
    assert main("study", "grid.toml", "--workers", "1", cwd=folder).returncode == 0
    done = main("run", "--reproduce", f"out/study:{label}:2", "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    saved = study.load(folder / "out" / "study" / "study.nc").sel(case=label, trial=2)
    assert json.loads(done.stdout)["final_position_m"] == saved.final_position_w.values.tolist()
    assert f"identical to the saved trial 2 of {label}" in done.stderr


@pytest.mark.parametrize(
    ("line", "told"),
    [
        (["study"], "the following arguments are required: FILE.toml"),
        (["study", "no.toml"], "cannot read the configuration no.toml"),
        (["study", "grid.toml", "--over", "robot"], "--over robot given"),
        (["study", "grid.toml", "--robots", "4"], "robots given by an option and by the grid"),
        (["study", "grid.toml", "--config", "grid.toml"], "study takes its file by itself"),
        (["study", "grid.toml", "--friction", "0.5"], "--friction given, but the study has point masses alone"),
    ],
)
def test_nonsense_is_one_line_and_leaves_nothing(main, folder, line, told):
    done = main(*line, cwd=folder)
    assert done.returncode == 2
    assert told in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (folder / "out").exists()


@pytest.mark.slow
def test_killed_at_any_moment_it_resumes_to_the_same_bytes(dynabot, started, folder):
    """The moments are random, what comes of them is not: whenever a study is killed, nothing is half written."""
    line = ["study", "grid.toml", "--trials", "600", "--workers", "2"]
    began = time.monotonic()
    assert dynabot(*line, "--out", "whole", cwd=folder).returncode == 0
    spent, draw = time.monotonic() - began, random.Random(0)
    whole = (folder / "whole" / "study.nc").read_bytes()
    for number in range(20):
        place = folder / f"killed{number}"
        process = started(*line, "--out", place, cwd=folder)
        time.sleep(draw.uniform(0.0, spent))
        os.killpg(process.pid, signal.SIGKILL)
        process.wait(timeout=60)
        if place.is_dir():
            assert {file.name for file in place.iterdir()} <= {".chunks", ".lock"} or (place / "study.nc").is_file()
        kept = any((place / ".chunks").glob("*.npz"))
        done = dynabot(*line, "--out", place, *(["--resume"] if kept else []), cwd=folder)
        assert done.returncode == 0, done.stderr
        assert (place / "study.nc").read_bytes() == whole


def test_what_takes_one_configuration_says_so(main, folder):
    (folder / "grid.toml").write_text(GRID.replace("robots = [2, 3]", "duration = [2.0, 3.0]"))
    assert main("study", "grid.toml", "--workers", "1", cwd=folder).returncode == 0
    report = main("report", "out/study", cwd=folder)
    assert (report.returncode, report.stderr.count("\n")) == (2, 1)
    assert "is a grid of 4 configurations, a report is of one" in report.stderr
    power = main("power", "out/study", "--cases", "a", "b", "--measure", "arrival_s", cwd=folder)
    assert (power.returncode, power.stderr.count("\n")) == (2, 1)
    assert "is a grid of several durations, a pilot must have one" in power.stderr
