import dataclasses
import json

import pytest

from dynabot_mj import cli
from dynabot_mj.estimation.parameters import DEFAULT
from dynabot_mj.experiments.estimators import estimate
from dynabot_mj.sensing.logs import log as logs


@pytest.mark.parametrize("extension", ["csv", "nc"])
def test_the_command_writes_the_same_from_both_formats(replayed, driven, tmp_path, capsys, extension):
    path = tmp_path / f"log.{extension}"
    logs.write(path, driven)
    assert cli.main(["estimate", str(path), "--out", str(tmp_path / "out"), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document == {**json.loads(json.dumps(estimate.document(replayed))), "log": path.name}
    assert json.loads((tmp_path / "out" / "estimate.json").read_text()) == document
    for name, track in replayed.tracks.items():
        assert (tmp_path / "out" / f"track_{name}.csv").read_text() == estimate.track_csv(track)
    assert (tmp_path / "out" / "estimate.png").stat().st_size > 10_000


def test_the_command_runs_the_estimators_that_are_asked_for(driven, tmp_path, capsys):
    path, folder = tmp_path / "log.csv", tmp_path / "out"
    logs.write(path, driven)
    chosen = ["--estimators", "coupled", "--filters", "filterpy", "--out", str(folder)]
    assert cli.main(["estimate", str(path), *chosen]) == 0
    printed = capsys.readouterr().out
    assert "| coupled " in printed
    assert "| gps " not in printed
    visible = {file.name for file in folder.iterdir() if not file.name.startswith(".")}
    assert visible == {"estimate.json", "estimate.md", "estimate.png", "track_coupled.csv"}
    assert json.loads((folder / "estimate.json").read_text())["filters"] == "filterpy"


def test_the_filters_assume_what_the_configuration_says(replayed, driven, tmp_path, capsys):
    path, config = tmp_path / "log.csv", tmp_path / "robot.toml"
    logs.write(path, driven)
    options = ["estimate", str(path), "--config", str(config), "--out", str(tmp_path / "out"), "--json"]
    config.write_text("runs = 3\n[filter]\nposition_noise = 5.0\n")
    assert cli.main(options) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["parameters"] == dataclasses.asdict(DEFAULT) | {"position_noise": 5.0}
    coupled = document["rows"][-1]
    assert coupled["final_position_m"] != pytest.approx(replayed.rows[-1].final_position_m, abs=0.01)
    config.write_text("[filter]\nposition_noise = -5.0\n")
    assert cli.main(options) == 2
    told = "dynabot: filter.position_noise = -5 given, it must be positive and at most 1e+06\n"
    assert capsys.readouterr().err == told


def test_a_malformed_log_is_one_line_and_exit_code_2(driven, tmp_path, capsys):
    path = tmp_path / "log.csv"
    logs.write(path, driven)
    lines = path.read_text().splitlines()
    lines[7] = "soon" + lines[7][lines[7].index(",") :]
    path.write_text("\n".join(lines))
    assert cli.main(["estimate", str(path), "--out", str(tmp_path / "out")]) == 2
    printed = capsys.readouterr()
    assert printed.err == f"dynabot: {path}, line 8, column time_s: 'soon' is not a number\n"
    assert printed.out == ""
    assert not (tmp_path / "out").exists()
