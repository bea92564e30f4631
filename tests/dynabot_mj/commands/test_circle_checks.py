import json

import pytest

from dynabot_mj import cli
from dynabot_mj.experiments.estimators import consistency, troubles


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
