import json

import pytest

from dynabot_mj import cli
from dynabot_mj.experiments.estimators import consistency, troubles
from dynabot_mj.sensing.logs import log as logs


def test_circle_writes_its_results_and_repeats_them_from_its_file(tmp_path, capsys):
    options = ["--runs", "2", "--duration", "30", "--seed", "4", "--json"]
    log = tmp_path / "first.csv"
    assert cli.main(["circle", *options, "--log", str(log), "--out", str(tmp_path / "a")]) == 0
    document = json.loads(capsys.readouterr().out)
    assert (document["runs"], document["seed"], document["duration_s"]) == (2, 4, 30.0)
    names = {file.name for file in (tmp_path / "a").iterdir() if not file.name.startswith(".")}
    assert names == {"circle.json", "circle.md", "circle.toml", "fig_3.png", "errors.png"}
    assert json.loads((tmp_path / "a" / "circle.json").read_text()) == document
    recorded = logs.read(log)
    assert recorded.position_w is not None
    assert len(recorded.time) == len(recorded.heading) > 800
    again = ["circle", "--config", str(tmp_path / "a" / "circle.toml"), "--json", "--out", str(tmp_path / "b")]
    assert cli.main(again) == 0
    assert json.loads(capsys.readouterr().out) == document


def test_circle_prints_a_table_of_other_sensors(tmp_path, capsys):
    (tmp_path / "better.toml").write_text(
        "runs = 3\nduration = 30.0\n[sensors.gps]\nposition_noise = 0.1\n[filter]\nposition_noise = 0.1\n"
    )
    options = ["--config", str(tmp_path / "better.toml"), "--runs", "1", "--path", "line", "--out", str(tmp_path)]
    assert cli.main(["circle", *options]) == 0
    out = capsys.readouterr().out
    assert "# Estimators on the line, kinematic plant: 1 runs of 30 s" in out
    assert "| gps       | 0." in out
    assert f"results in {tmp_path}" in out


def test_without_any_fix_there_is_no_figure_of_merit(tmp_path, capsys):
    (tmp_path / "blind.toml").write_text('duration = 30.0\n[[sensors.faults]]\nkind = "outage"\n')
    options = ["--config", str(tmp_path / "blind.toml"), "--runs", "1", "--json", "--out", str(tmp_path)]
    assert cli.main(["circle", *options]) == 0
    document = json.loads(capsys.readouterr().out)
    assert all(row["uncertainty_m"] == {"mean": None, "sd": None, "n": 0} for row in document["rows"])
    assert document["ordered_fraction"]["n"] == 0


@pytest.mark.parametrize(
    ("options", "what"),
    [
        (["--runs", "0"], "--runs 0"),
        (["--seed", "-1"], "--seed -1"),
        (["--duration", "nan"], "duration"),
        (["--period", "1"], "--period 1: input should be less than or equal to 0.2 s"),
        (["--plant", "particle"], "particle"),
        (["--plant", "rigid", "--path", "line"], "its tether allows: circle"),
        (["--config", "nowhere.toml"], "cannot read the configuration nowhere.toml"),
        (["--log", "log.txt"], ".csv and .nc"),
        (["--log", "log.csv", "--config", "late.toml"], "stamp_error = 0.2 s given, it must not exceed gps.latency"),
    ],
)
def test_bad_input_is_told_in_one_line(options, what, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "late.toml").write_text("[sensors.gps]\nstamp_error = 0.2\n")
    assert cli.main(["circle", *options]) == 2
    error = capsys.readouterr().err
    assert what in error
    assert error.count("\n") == 1


@pytest.mark.parametrize("name", ["grouping", "consistency", "faults"])
def test_checks_write_and_print_their_tables(name, tmp_path, capsys, monkeypatch):
    some = troubles.every()[:2]
    monkeypatch.setattr(troubles, "every", lambda: some)
    # 30 s instead of 100 s: what the check finds is asked by its own tests.
    monkeypatch.setattr(consistency, "DURATION", 30.0)
    options = ["circle", f"--{name}", "--runs", "2", "--seed", "1", "--out", str(tmp_path / "a")]
    assert cli.main(options) == 0
    assert f"results in {tmp_path / 'a'}" in capsys.readouterr().out
    names = {file.name for file in (tmp_path / "a").iterdir() if not file.name.startswith(".")}
    assert names == {f"{name}.json", f"{name}.md"}
    document = json.loads((tmp_path / "a" / f"{name}.json").read_text())
    assert (document["seed"], document["runs"]) == (1, 2)


@pytest.mark.parametrize(
    ("options", "what"),
    [
        (["--faults", "--plant", "rigid"], "--plant given with --faults"),
        (["--grouping", "--runs", "1"], "--runs 1 given with --grouping"),
        (["--consistency", "--seed", "-1"], "--seed -1"),
        (["--grouping", "--faults"], "not allowed with"),
    ],
)
def test_bad_input_to_a_check_is_told_in_one_line(options, what, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["circle", *options]) == 2
    error = capsys.readouterr().err
    assert what in error
    assert error.count("\n") == 1
    assert not any(tmp_path.iterdir())
