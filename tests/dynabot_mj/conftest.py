import subprocess
import sys
from pathlib import Path

import pytest

from dynabot_mj import configuration, opengl, study


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
