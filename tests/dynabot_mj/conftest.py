import signal
import subprocess
import sys
from pathlib import Path

import pytest

from dynabot_mj import cli, configuration, opengl, study


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
