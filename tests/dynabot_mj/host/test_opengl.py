import ctypes
import os
import types
import warnings

import pytest

from dynabot_mj.host import opengl
from dynabot_mj.host.opengl import GraphicsError

VARIABLES = ("MUJOCO_GL", "DISPLAY", "WAYLAND_DISPLAY")


@pytest.fixture
def linux(monkeypatch):
    """Nothing is set, on Linux with the libraries that the test names."""
    for variable in VARIABLES:
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setattr(opengl.sys, "platform", "linux")

    def has(*libraries):
        def load(library):
            if not library.startswith(libraries or ("-",)):
                raise OSError(library)

        monkeypatch.setattr(ctypes, "CDLL", load)

    return has


@pytest.mark.parametrize(
    ("libraries", "chosen"), [(("libEGL", "libOSMesa"), "egl"), (("libOSMesa",), "osmesa"), (("libEGL",), "egl")]
)
def test_what_needs_no_display_is_chosen(linux, libraries, chosen):
    linux(*libraries)
    assert opengl.backend() == chosen


def test_without_a_library_the_package_is_named(linux, monkeypatch):
    linux()
    with pytest.raises(GraphicsError, match="apt-get install libegl1 libgl1-mesa-dri"):
        opengl.backend()
    monkeypatch.setenv("DISPLAY", ":0")
    assert opengl.backend() == "glfw"


def test_what_the_user_has_set_is_used(linux, monkeypatch):
    linux("libEGL")
    monkeypatch.setenv("MUJOCO_GL", "OSMesa")
    assert opengl.backend() == "osmesa"
    monkeypatch.setenv("MUJOCO_GL", "disable")
    with pytest.raises(GraphicsError, match="MUJOCO_GL=disable cannot draw; unset it, or set it to one of egl, osmesa"):
        opengl.backend()


@pytest.mark.parametrize(("system", "chosen"), [("darwin", "cgl"), ("win32", "glfw")])
def test_elsewhere_it_is_what_mujoco_has_there(linux, monkeypatch, system, chosen):
    linux()
    monkeypatch.setattr(opengl.sys, "platform", system)
    assert opengl.backend() == chosen


def set_for_dm_control(monkeypatch, **kept):
    """Returns the environment in which dm_control would be imported."""
    monkeypatch.setattr(os, "environ", dict(kept))
    with opengl.for_dm_control():
        return dict(os.environ)


def test_dm_control_is_told_only_where_that_helps(linux, monkeypatch):
    monkeypatch.setattr(opengl.importlib, "import_module", lambda name: None)
    linux()
    assert set_for_dm_control(monkeypatch) == {}  # no library: importing dm_control must not fail
    linux("libEGL")
    for kept in ({"DISPLAY": ":0"}, {"MUJOCO_GL": "osmesa"}, {"MUJOCO_GL": ""}):
        assert set_for_dm_control(monkeypatch, **kept) == kept
    assert set_for_dm_control(monkeypatch) == {"MUJOCO_GL": "egl"}
    monkeypatch.setattr(opengl.importlib, "import_module", lambda name: 1 / 0)  # a driver that is broken
    assert set_for_dm_control(monkeypatch) == {}


def test_a_context_that_cannot_be_made_is_told_with_what_mends_it(monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "egl")

    def broken(name):
        raise AttributeError("'NoneType' object has no attribute 'eglQueryString'")

    monkeypatch.setattr(opengl.importlib, "import_module", broken)
    with pytest.raises(
        GraphicsError, match=r"OpenGL egl does not work .*eglQueryString.*unset MUJOCO_GL, or apt-get install libegl1"
    ):
        opengl.context(64, 48).__enter__()


class GLFWError(UserWarning):
    """As that of GLFW."""


class ContextOfNothing:
    """As GLFW makes it without a display."""

    def __init__(self, width, height):
        warnings.warn("no display", GLFWError, stacklevel=1)

    def make_current(self):
        pass


def test_a_context_of_nothing_is_none(monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "glfw")
    monkeypatch.setattr(
        opengl.importlib, "import_module", lambda name: types.SimpleNamespace(GLContext=ContextOfNothing)
    )
    with pytest.raises(GraphicsError, match=r"glfw does not work \(no display\): unset MUJOCO_GL, or log in to"):
        opengl.context(64, 48).__enter__()
