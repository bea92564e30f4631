import json

import numpy as np
import pytest
import xarray as xr

from dynabot_mj import study

A, B = "particle/gauss-markov/gps", "rigid/gauss-markov/gps"
LINE = ["--cases", A, B, "--measure", "collision_footprint"]


@pytest.fixture
def pilot(dataset, tmp_path):
    """A saved study of 40 trials, in which the hulls of A touch in 12 of them and those of B in none."""
    found = xr.concat([dataset] * 14, "trial", data_vars="minimal").isel(trial=slice(40))
    found = found.assign_coords(trial=np.arange(40))
    found["collision_footprint"] = (("case", "trial"), np.array([np.repeat([1.0, 0.0], [12, 28]), np.zeros(40)]))
    found.attrs = dataset.attrs
    (tmp_path / "pilot").mkdir()
    study.save(found, tmp_path / "pilot" / "study.nc")
    return tmp_path / "pilot"


def test_the_trials_are_told_and_written(dynabot, pilot, tmp_path):
    done = dynabot("power", "pilot", *LINE, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"# Trials for collision_footprint, {A} - {B}\n")
    assert done.stdout.endswith("results in out/power\n")
    place = tmp_path / "out" / "power"
    assert {file.name for file in place.iterdir() if file.name[0] != "."} == {"power.json", "power.md", "power.png"}
    assert (place / "power.png").read_bytes()[:4] == b"\x89PNG"


def test_the_document_is_the_file_and_the_same_each_time(main, pilot, tmp_path):
    line = ["power", pilot / "study.nc", "--cases", A, B, "--measure", "top_speed_mps", "--difference", 0.01, "--json"]
    first = main(*line, "--out", tmp_path / "first")
    again = main(*line, "--out", tmp_path / "again")
    assert first.returncode == 0, first.stderr
    told = json.loads(first.stdout)
    assert told == json.loads((tmp_path / "first" / "power.json").read_text(encoding="utf-8"))
    assert told == json.loads(again.stdout)
    assert told["needs"][0]["power"]["low"] >= 0.8
    assert told["unit"] == "m/s"


def test_fewer_than_a_point_is_noted(main, pilot, tmp_path):
    done = main("power", pilot, *LINE, "--difference", 0.25, "--json", cwd=tmp_path)
    assert done.returncode == 0
    assert done.stderr == "note: --difference is in points, less than one given; a share is --difference 25\n"
    assert json.loads(done.stdout)["needs"][0]["difference"] == pytest.approx(0.0025)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["absent", *LINE], "there is no study at absent"),
        (["pilot"], "the following arguments are required: --cases, --measure"),
        (["pilot", "--cases", A, "--measure", "arrival_s"], "argument --cases: expected 2 arguments"),
        (["pilot", "--cases", A, "rigid/gauss-markov/gsp", "--measure", "arrival_s"], "did you mean rigid/"),
        (["pilot", "--cases", A, B, "--measure", "arival_s"], "invalid choice: 'arival_s'; did you mean arrival_s?"),
        (["pilot", "--cases", A, B, "--measure", "completion"], "is not compared between cases of another plant"),
        (["pilot", *LINE, "--difference", "0"], "--difference 0 given, it must be a number of points other than 0"),
        (["pilot", *LINE, "--difference", "many"], "invalid float value: 'many'"),
        (["pilot", *LINE, "--power", "80"], "a fraction is meant: 0.8?"),
        (["pilot", "--cases", A, B, "--measure", "arrival_s"], "which no trial of"),
    ],
)
def test_nonsense_is_one_line_and_code_2(main, pilot, tmp_path, options, message):
    done = main("power", *options, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert message in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert [file.name for file in tmp_path.iterdir()] == ["pilot"]
