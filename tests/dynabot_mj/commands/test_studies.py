import os
import signal
from dataclasses import replace

import pytest

from dynabot_mj import study
from dynabot_mj.commands import studies
from dynabot_mj.plants import kinds
from dynabot_mj.study import campaign, trial_chunks
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


def test_parts_that_are_kept_are_counted_over_all_studies(short, tmp_path, monkeypatch):
    for name, kind in kinds.KINDS.items():
        monkeypatch.setitem(kinds.KINDS, name, replace(kind, chunk=2))
    brief = replace(short, duration=1.0)
    told = [(trial_chunks.chunks(campaign.single(brief)), tmp_path / name) for name in "ab"]
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
