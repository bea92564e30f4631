import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from dynabot_mj import cli, study
from dynabot_mj.experiments.estimators import circle, estimate, kinematic
from dynabot_mj.experiments.formation import loop_benchmark, radio_benchmark
from dynabot_mj.host import opengl
from dynabot_mj.report import material
from dynabot_mj.sensing import replay
from dynabot_mj.sensing.logs import log
from dynabot_mj.sensing.options import SensorOptions, WheelErrors
from dynabot_mj.study import configuration


@pytest.fixture(scope="session")
def short():
    """A study that takes a second."""
    return configuration.build({}, trials=3, duration=14.0, estimators=["gps"], plants=["particle", "rigid"])


@pytest.fixture(scope="session")
def dataset(short):
    return study.run(short)


@pytest.fixture
def saved(tmp_path):
    """Returns the bytes of a Dataset as a file."""

    def content(dataset):
        study.save(dataset, tmp_path / "study.nc")
        return (tmp_path / "study.nc").read_bytes()

    return content


@pytest.fixture(scope="session")
def command():
    """The command line's real entry point."""
    return Path(sys.executable).parent / "dynabot"


@pytest.fixture(scope="session")
def dynabot(command):
    """Runs the command line."""

    def run(*arguments, cwd=None):
        line = [command, *map(str, arguments)]
        return subprocess.run(line, capture_output=True, text=True, timeout=300, cwd=cwd, check=False)

    return run


@pytest.fixture
def main(monkeypatch, capsys):
    """Runs the command line in this process, which has imported what takes a new one two seconds."""
    handlers = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGHUP)}

    def run(*arguments, cwd="."):
        line = list(map(str, arguments))
        capsys.readouterr()
        with monkeypatch.context() as patch:
            patch.setattr(sys, "argv", ["dynabot", *line])
            patch.chdir(cwd)
            code = cli.main(line)
        out, err = capsys.readouterr()
        return subprocess.CompletedProcess(line, code, out, err)

    yield run
    for number, handler in handlers.items():
        signal.signal(number, handler)


@pytest.fixture(scope="module")
def small_report():
    """Reports on a tether with 2 runs of 30 s instead of 20 of 100 s, and with films of few small pictures."""
    run = material.circle.run
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            material.circle, "run", lambda asked, progress: run(replace(asked, runs=2, duration=30.0), progress)
        )
        patch.setattr(material, "_SHOT", replace(material._SHOT, width=480, height=270, rate=4.0, samples=0))
        yield


@pytest.fixture(scope="module")
def small_loop():
    """Makes what the loop and the radio are timed on small."""
    with pytest.MonkeyPatch.context() as patch:
        for name, value in {
            "HEADLINE": ("gauss-markov", 3, 1),
            "_RIGID_TRIALS": (1, 3),
            "_PARTICLE_TRIALS": (1, 5),
            "_SHARED_TRIALS": {"particle": 2, "rigid": 2},
            "_EVENTS": {"particle": 8, "rigid": 6},
            "_TURN": 4,
        }.items():
            patch.setattr(loop_benchmark, name, value)
        patch.setattr(radio_benchmark, "_TRIALS", 2)
        patch.setattr(radio_benchmark, "_EVENTS", 4)
        yield


@pytest.fixture
def small_tuning(monkeypatch):
    """Makes all of a tuning small: the same work, on fewer and shorter courses."""
    for name, value in {
        "COURSES": 2,
        "DURATION": 2.0,
        "HELD_OUT": 3,
        "FRICTIONS": (0.75,),
        "PAYLOADS": (0.0,),
        "PERIODS": (0.036,),
        "_ITERATIONS": 4,
    }.items():
        monkeypatch.setattr(f"dynabot_mj.experiments.vehicle.tune_traction.{name}", value)


@pytest.fixture(scope="session")
def recorded():
    """Returns the log of a vehicle that drives around a circle."""

    def record(duration, *faults):
        truth = kinematic.follow("circle", 1, 5, duration, 0.018)
        return log.from_run(replay.record(truth, SensorOptions(faults=faults), 0.036, 5), truth, 0, WheelErrors())

    return record


@pytest.fixture(scope="session")
def driven(recorded):
    """A log of nine seconds."""
    return recorded(9.0)


@pytest.fixture(scope="session")
def replayed(driven):
    """What the estimators make of it."""
    return estimate.run("log.csv", driven)


@pytest.fixture(scope="session")
def circled():
    """The tether experiment as short as it may be."""
    return circle.run(circle.request({}, runs=2, duration=30.0))


@pytest.fixture(scope="session")
def polled():
    """Returns what is got once it is good, or at last: a busy machine only takes longer."""

    def poll(get, good=bool, seconds=240.0):
        end = time.monotonic() + seconds
        while not good(found := get()) and time.monotonic() < end:
            time.sleep(0.1)
        return found

    return poll


@pytest.fixture
def started(command):
    """Starts the command line beside a test, which it does not outlive, not even by a pipe."""
    processes = []

    def start(*arguments, cwd=None):
        line = [command, *map(str, arguments)]
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        # A session of its own: its group gets signals as from a terminal.
        processes.append(subprocess.Popen(line, **pipes, text=True, cwd=cwd, start_new_session=True))
        return processes[-1]

    yield start
    for process in processes:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


@pytest.fixture
def without_graphics(monkeypatch, tmp_path):
    """No OpenGL library can be loaded, and there is no display."""
    for library in ("libEGL.so", "libEGL.so.0", "libEGL.so.1", "libOSMesa.so", "libOSMesa.so.8", "libGL.so.1"):
        (tmp_path / library).touch()
    monkeypatch.setenv("LD_LIBRARY_PATH", str(tmp_path))
    for variable in ("DISPLAY", "WAYLAND_DISPLAY", "MUJOCO_GL"):
        monkeypatch.delenv(variable, raising=False)


@pytest.fixture(scope="session")
def graphics():
    """Skips what needs a picture where none can be drawn."""
    try:
        with opengl.context(64, 48):
            return
    except opengl.GraphicsError as error:
        pytest.skip(str(error))
