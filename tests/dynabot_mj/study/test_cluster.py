"""A Dask cluster of separate processes on this machine; clients are processes too, as in test_execution.py."""

import json
import os
import signal
import subprocess
import sys

import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.study import campaign, execution, layout, provenance, trial_chunks

pytest.importorskip("distributed")

GRID = """
trials = 2
duration = 14.0
plants = ["particle"]
estimators = ["gps"]

[grid]
robots = [2, 3]
"""
# A worker loads it before anything of ours.
OTHER_VERSION = """
import importlib.metadata


def version(distribution_name, known=importlib.metadata.version):  # a default, since Dask loads this more than once
    return "9.9" if distribution_name == "mujoco" else known(distribution_name)


importlib.metadata.version = version
"""
NOTHING_OF_OURS = """
import sys

sys.modules["dynabot_mj"] = None
"""


@pytest.fixture(scope="module")
def process(tmp_path_factory):
    """Starts a process of Dask, which does not outlive the tests."""
    folder, processes = tmp_path_factory.mktemp("dask"), []

    def start(program, *arguments):
        line = [sys.executable, "-m", f"distributed.cli.dask_{program}", *map(str, arguments)]
        told = folder / f"{len(processes)}.txt"
        with told.open("wb") as file:
            processes.append(subprocess.Popen(line, cwd=folder, stdout=file, stderr=subprocess.STDOUT))
        return processes[-1], told

    yield start
    for one in processes:
        one.kill()
        one.wait()


@pytest.fixture(scope="module")
def address(process, polled, tmp_path_factory):
    """Address of a scheduler on a port that was free."""
    file = tmp_path_factory.mktemp("scheduler") / "scheduler.json"
    process("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", file)
    assert polled(lambda: file.is_file() and file.read_text().endswith("}"))
    return json.loads(file.read_text())["address"]


@pytest.fixture
def worker(process, address, polled):
    """Starts workers that end with their test."""
    workers = []

    def start(*options):
        own = ["--no-nanny", "--nthreads", "1", "--no-dashboard", "--death-timeout", "60"]
        one, told = process("worker", address, *own, *options)
        workers.append(one)
        assert polled(lambda: "Registered to:" in told.read_text()), told.read_text()
        return one

    yield start
    for one in workers:
        one.terminate()  # it tells the scheduler
        try:
            one.wait(30)
        except subprocess.TimeoutExpired:
            one.kill()


@pytest.fixture
def study(dynabot, address, tmp_path):
    """Runs a study on the cluster."""

    def run(scheduler=address):
        (tmp_path / "grid.toml").write_text(GRID)
        return dynabot("study", "grid.toml", "--scheduler", scheduler, "--out", "there", cwd=tmp_path)

    return run


def refusal(done):
    """Returns the one line that a command ends with."""
    assert done.returncode == 2, done.stderr
    (line,) = [line for line in done.stderr.splitlines() if not line.startswith("note:")]
    return line


def test_a_scheduler_without_workers_is_refused(study, address):
    line = f"dynabot: the Dask scheduler at '{address}' has no workers; start some: dask worker {address}"
    assert refusal(study()) == line


@pytest.fixture
def here(tmp_path):
    """Returns the bytes of a study that is done in this process, written as the command does."""

    def content(text):
        made = campaign.parse(text, "here")
        done = execution.execute(trial_chunks.chunks(made), execution.Execution(), execution.Watch())
        layout.write(made, done, tmp_path / "here.nc")
        return (tmp_path / "here.nc").read_bytes()

    return content


def test_a_cluster_of_processes_gives_the_same_bytes(study, worker, here, tmp_path):
    worker()
    done = study()
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "there" / "study.nc").read_bytes() == here(GRID)


@pytest.mark.parametrize(
    ("preload", "told"),
    [
        (OTHER_VERSION, "would compute otherwise: mujoco 9.9 there and {mujoco} here"),
        pytest.param(NOTHING_OF_OURS, "can they import dynabot_mj? ModuleNotFoundError(", marks=pytest.mark.slow),
    ],
    ids=["another version", "without the package"],
)
def test_a_worker_that_would_compute_something_else_is_refused(study, worker, tmp_path, preload, told):
    (tmp_path / "preload.py").write_text(preload)
    worker("--preload", tmp_path / "preload.py")
    line = refusal(study())
    assert told.format(**provenance.computation()) in line, line
    assert not list(tmp_path.glob("there/*.nc"))


def test_a_worker_that_joins_later_is_asked_too():
    chunk = trial_chunks.chunks(campaign.load({"trials": 1}, "here"))[0]
    expected = {**provenance.computation(), "mujoco": "9.9"}
    with pytest.raises(InputError, match=r"would compute otherwise: mujoco [\d.]+ there and 9\.9 here"):
        execution._run(0, chunk, 1, expected)


@pytest.mark.slow
def test_no_scheduler_is_told_so(study):
    assert refusal(study(scheduler="tcp://127.0.0.1:9")) == "dynabot: no Dask scheduler answers at 'tcp://127.0.0.1:9'"


@pytest.mark.slow
def test_a_worker_that_is_killed_costs_time_and_no_results(worker, started, polled, address, here, tmp_path):
    text = GRID.replace("14.0", "30.0").replace("[2, 3]", "[2, 3, 4, 5]")
    text = text.replace('["gps"]', '["gps", "decoupled"]').replace("trials = 2", "trials = 20")
    (tmp_path / "grid.toml").write_text(text)
    victim, _ = worker(), worker()
    command = started("study", tmp_path / "grid.toml", "--scheduler", address, "--out", tmp_path / "killed")
    assert polled(lambda: list(tmp_path.glob("killed/.chunks/*.npz")))
    assert command.poll() is None
    os.kill(victim.pid, signal.SIGKILL)
    _, stderr = command.communicate(timeout=300)
    assert command.returncode == 0, stderr
    assert (tmp_path / "killed" / "study.nc").read_bytes() == here(text)
