import argparse
import os
import signal
from dataclasses import replace

import pytest

from dynabot_mj import study
from dynabot_mj.commands import parsers, studies
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.plants import kinds
from dynabot_mj.study import campaign
from dynabot_mj.study.execution import Execution


def test_ctrl_c_keeps_finished_parts_and_resume_continues(main, started, polled, tmp_path):
    options = ["--trials", "1000", "--duration", "40", "--plants", "particle", "--estimators", "decoupled"]
    options += ["--out", str(tmp_path)]
    process = started("compare", *options, "--workers", "2")
    assert polled(lambda: list(tmp_path.glob(".chunks/*.npz")))
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=240)
    assert process.returncode == 130
    assert err.splitlines()[-1].startswith("dynabot: interrupted")
    assert "Traceback" not in err
    assert out == ""
    assert [path.name for path in tmp_path.iterdir()] == [".chunks"]
    assert not [path for path in tmp_path.rglob("*") if "partial" in path.name]
    kept = len(list(tmp_path.glob(".chunks/*.npz")))
    assert err.splitlines()[-1] == f"dynabot: interrupted; kept {kept} of 5 parts, --resume continues from them"
    resumed = main("compare", *options, "--resume")
    assert resumed.returncode == 0
    assert resumed.stderr.startswith(f"note: kept {kept} of 5 parts")
    assert not (tmp_path / ".chunks").exists()


def parsed(*line):
    return argparse.ArgumentParser(parents=[parsers.study()]).parse_args(list(line))


def test_options_stand_above_the_file_and_the_file_above_the_defaults(tmp_path):
    (tmp_path / "study.toml").write_text("trials = 7\nseed = 3\n[vehicle]\npayload = 2.0\n")
    options = parsed("--config", str(tmp_path / "study.toml"), "--seed", "4")
    setup = studies.build(options, {"trials": 3, "estimators": ["gps"]})
    assert (setup.trials, setup.seed, setup.vehicle.payload, setup.estimators) == (7, 4, 2.0, ("gps",))


def test_options_that_do_nothing_are_refused_and_keys_of_a_file_are_told(tmp_path, capsys):
    with pytest.raises(InputError, match="--friction given, but the study has point masses alone"):
        studies.build(parsed("--friction", "0.5"), plants=["particle"])
    (tmp_path / "study.toml").write_text("plants = ['particle']\n[vehicle]\nfriction = 0.5\ngains = 'first'\n")
    studies.build(parsed("--config", str(tmp_path / "study.toml")))
    told = capsys.readouterr().err
    assert told.startswith(f"note: vehicle.friction, vehicle.gains in {tmp_path / 'study.toml'}: no effect, since ")
    assert told.count("\n") == 1


def test_parts_that_are_kept_are_counted_over_all_studies(short, tmp_path, monkeypatch):
    for name, kind in kinds.KINDS.items():
        monkeypatch.setitem(kinds.KINDS, name, replace(kind, chunk=2))
    brief = replace(short, duration=1.0)
    told = [(campaign.single(brief), tmp_path / name) for name in "ab"]
    assert studies.told_kept(told) == ""

    def interrupt(share):
        if share > 0.6:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        study.run(brief, Execution(chunks=tmp_path / "a" / ".chunks"), interrupt)
    kept = len(list(tmp_path.glob("a/.chunks/*.npz")))
    assert kept > 0
    # Two cases of three trials, two at a time, are four parts, in each of the studies.
    assert studies.told_kept(told) == f"kept {kept} of 8 parts"


def test_a_load_above_the_bound_is_told_and_one_within_its_digits_is_not(capsys):
    studies.note_load("gps", 1.00004, 1.0)
    assert capsys.readouterr().err == ""
    studies.note_load("gps", 1.0015, 1.0)
    assert capsys.readouterr().err.startswith("note: the rounded periods of gps load the processor 1.0015, above 1; ")
