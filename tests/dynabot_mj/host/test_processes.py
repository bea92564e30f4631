import os
import signal
import subprocess
import sys

import psutil
import pytest

from dynabot_mj.host import doctor

LINE = [
    "compare",
    "--trials",
    2000,
    "--duration",
    20,
    "--plants",
    "particle",
    "--estimators",
    "decoupled",
    "--workers",
    2,
    "--out",
]


def workers(parent):
    """The worker processes of a study, without the one that tracks what they share."""
    return [one for one in parent.children() if "spawn_main" in " ".join(one.cmdline())]


@pytest.fixture
def running(command, polled, tmp_path):
    """A study with two workers that has finished a part of its work."""
    process = subprocess.Popen(
        [command, *map(str, LINE), str(tmp_path)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert polled(lambda: list(tmp_path.glob(".chunks/*.npz")))
    yield process, psutil.Process(process.pid)
    if process.poll() is None:
        process.kill()
    process.communicate()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_these_signals_end_a_command_as_ctrl_c_does(main, monkeypatch, number):
    signal.signal(number, signal.SIG_DFL)  # nohup lets it be ignored, and then it stays so
    monkeypatch.setattr(doctor, "examine", lambda cores, figures_asked: os.kill(os.getpid(), number))
    done = main("doctor")
    assert (done.returncode, done.stdout) == (128 + number, "")
    assert done.stderr == f"dynabot: ended by {number.name}\n"


@pytest.mark.parametrize("number", [signal.SIGTERM, pytest.param(signal.SIGHUP, marks=pytest.mark.slow)])
def test_signals_of_batch_systems_end_a_study_as_ctrl_c_does(running, polled, number, tmp_path):
    process, parent = running
    children = parent.children(recursive=True)
    process.send_signal(number)
    out, err = process.communicate(timeout=240)
    assert process.returncode == 128 + number
    assert out == ""
    kept = len(list(tmp_path.glob(".chunks/*.npz")))
    (told,) = [line for line in err.splitlines() if not line.startswith(("note:", "compare:"))]
    assert told.startswith(f"dynabot: ended by {number.name}; kept {kept} of ")
    assert told.endswith(" parts, --resume continues from them")
    assert polled(lambda: not any(one.is_running() for one in children))
    assert [path.name for path in tmp_path.iterdir()] == [".chunks"]


def test_no_worker_outlives_a_parent_that_is_killed(running, polled):
    process, parent = running
    children = parent.children(recursive=True)
    assert len(workers(parent)) == 2
    process.kill()
    process.communicate(timeout=240)
    assert polled(lambda: not any(one.is_running() and one.status() != psutil.STATUS_ZOMBIE for one in children))


def test_a_worker_that_is_killed_is_one_line_and_its_work_is_not_lost(running, polled, tmp_path):
    process, parent = running
    children = parent.children(recursive=True)
    workers(parent)[0].kill()
    out, err = process.communicate(timeout=240)
    assert (process.returncode, out) == (1, "")
    lines = [line for line in err.splitlines() if not line.startswith(("note:", "compare:"))]
    assert len(lines) == 1
    assert lines[0].startswith("dynabot: a worker process died")
    assert "--resume" in lines[0]
    assert polled(lambda: not any(one.is_running() for one in children))
    assert list(tmp_path.glob(".chunks/*.npz"))


def test_a_script_without_a_main_guard_is_told_what_it_lacks(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "from dynabot_mj import study\n"
        "from dynabot_mj.study import configuration\n"
        "from dynabot_mj.study.execution import Execution\n"
        "setup = configuration.build({}, trials=300, duration=1.0, plants=['particle'], estimators=['gps'])\n"
        "study.run(setup, Execution(workers=2))\n",
        encoding="utf-8",
    )
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 1
    assert "below `if __name__ == '__main__':`" in done.stderr.splitlines()[-1]
    assert done.stderr.count("Traceback") == 1  # the caller's own, none of the workers'
