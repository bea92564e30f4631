"""OpenGL without a display: which library draws, a context of it, and what to install where there is none.

Nothing is drawn by studies, so nothing is loaded before a picture is asked for.
"""

import contextlib
import ctypes
import importlib
import os
import sys
import warnings
from collections.abc import Iterator
from typing import Any

from dynabot_mj.common.exceptions import DynabotError

BACKENDS = ("egl", "osmesa", "glfw")  # that MUJOCO_GL may name on Linux
MEND = {
    "egl": "apt-get install libegl1 libgl1-mesa-dri",
    "osmesa": "apt-get install libosmesa6",
    "glfw": "log in to a desktop, or start a virtual one: apt-get install xvfb, then xvfb-run dynabot ...",
}

_VARIABLE = "MUJOCO_GL"
_BINDINGS = "PYOPENGL_PLATFORM"
_LIBRARIES = {"egl": ("libEGL.so.1", "libEGL.so.0"), "osmesa": ("libOSMesa.so.8", "libOSMesa.so.6")}
_ELSEWHERE = {"darwin": "cgl", "win32": "glfw"}  # than on Linux: what MuJoCo has there


class GraphicsError(DynabotError):
    """Nothing can be drawn here."""


def backend() -> str:
    """Returns what will draw: what MUJOCO_GL says, else the first that needs no display and is there.

    Raises:
        GraphicsError: If MUJOCO_GL names none, or there is none.
    """
    possible = (*BACKENDS, *_ELSEWHERE.values())
    if asked := os.environ.get(_VARIABLE, "").lower():
        if asked not in possible:
            raise GraphicsError(f"{_VARIABLE}={asked} cannot draw; unset it, or set it to one of {', '.join(BACKENDS)}")
        return asked
    if sys.platform in _ELSEWHERE:
        return _ELSEWHERE[sys.platform]
    for name, libraries in _LIBRARIES.items():
        if any(_loads(library) for library in libraries):
            return name
    if has_display():
        return "glfw"
    raise GraphicsError(f"no OpenGL library to draw with: {MEND['egl']} (or {MEND['osmesa']})")


def has_display() -> bool:
    """Tells whether the environment names a display."""
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


@contextlib.contextmanager
def unasked() -> Iterator[None]:
    """Hides MUJOCO_GL from MuJoCo's import, which fails where it names what is not there: only pictures need it."""
    with _hidden(_VARIABLE):
        yield


def import_unasked() -> None:
    """Imports MuJoCo by `unasked` where MUJOCO_GL is set; elsewhere it may wait until it is needed."""
    if _VARIABLE in os.environ:
        with unasked():
            importlib.import_module("mujoco")


@contextlib.contextmanager
def for_dm_control() -> Iterator[None]:
    """Lets dm_control, which decides on what draws when it is imported, find what needs no display.

    For that it sets MUJOCO_GL on Linux without a display, where the user has set nothing and there is a library. Where
    there is none, dm_control's complaint about the missing display is not heard: nobody has asked for a picture yet.
    """
    if sys.platform != "linux" or _VARIABLE in os.environ or has_display():
        with _hidden(_BINDINGS):
            yield
        return
    with contextlib.suppress(Exception):  # a broken driver raises anything; then there is nothing to set
        name = backend()
        _bound(name)  # a library that cannot be bound must not be named
        os.environ[_VARIABLE] = name
    with warnings.catch_warnings(), _hidden(_BINDINGS):
        warnings.simplefilter("ignore")
        yield


@contextlib.contextmanager
def context(width: int, height: int) -> Iterator[None]:
    """Makes a context of OpenGL current in this thread while the `with` block runs.

    Args:
        width: Of the largest picture [pixels].
        height: Likewise.

    Raises:
        GraphicsError: If that fails.
    """
    name = backend()
    try:
        with warnings.catch_warnings(record=True) as complaints:
            warnings.simplefilter("always")
            opened = _bound(name).GLContext(width, height)
            opened.make_current()
        # GLFW's failures are warnings, and its context is one of nothing then.
        if failures := [one for one in complaints if one.category.__name__ == "GLFWError"]:
            raise RuntimeError(failures[0].message)
    except Exception as error:  # a broken driver raises whatever its bindings do, from AttributeError to GLError
        reason = (str(error).strip() or type(error).__name__).splitlines()[0]
        mend = MEND[name] if sys.platform == "linux" else "see `dynabot doctor`"
        if _VARIABLE in os.environ:
            mend = f"unset {_VARIABLE}, or {mend}"
        raise GraphicsError(f"OpenGL {name} does not work ({reason}): {mend}") from error
    try:
        yield
    finally:
        opened.free()


def require() -> None:
    """Makes sure, before any work, that something can be drawn.

    Raises:
        GraphicsError: If not.
    """
    with context(64, 64):
        pass


def _bound(name: str) -> Any:
    """Returns MuJoCo's module of a back end, whichever one PYOPENGL_PLATFORM names for other programs."""
    with _hidden(_BINDINGS):
        return importlib.import_module(f"mujoco.{name}")


@contextlib.contextmanager
def _hidden(variable: str) -> Iterator[None]:
    asked = os.environ.pop(variable, None)
    try:
        yield
    finally:
        if asked is not None:
            os.environ[variable] = asked


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True
