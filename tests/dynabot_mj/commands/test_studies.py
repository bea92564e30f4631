import os
import signal


def test_ctrl_c_keeps_finished_parts_and_resume_continues(main, started, polled, tmp_path):
    options = ["--trials", "300", "--duration", "40", "--plants", "particle", "--estimators", "decoupled"]
    options += ["--out", str(tmp_path)]
    process = started("compare", *options, "--workers", "2")
    assert polled(lambda: list(tmp_path.glob(".chunks/*.pickle")))
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=240)
    assert process.returncode == 130
    assert err.splitlines()[-1].startswith("dynabot: interrupted")
    assert "Traceback" not in err
    assert out == ""
    assert [path.name for path in tmp_path.iterdir()] == [".chunks"]
    assert not [path for path in tmp_path.rglob("*") if "partial" in path.name]
    kept = len(list(tmp_path.glob(".chunks/*.pickle")))
    assert err.splitlines()[-1] == f"dynabot: interrupted; kept {kept} of 6 parts, --resume continues from them"
    resumed = main("compare", *options, "--resume")
    assert resumed.returncode == 0
    assert resumed.stderr.startswith(f"note: kept {kept} of 6 parts")
    assert not (tmp_path / ".chunks").exists()
