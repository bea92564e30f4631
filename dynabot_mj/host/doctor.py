"""What works on this machine, and the one line that mends what does not.

Each OpenGL back end is tried in a process of its own, since the first import of MuJoCo chooses one for good: it draws
one small frame, which must not be blank. Studies need none of them; videos need one.
"""

import importlib.util
import os
import platform
import subprocess
import sys
import textwrap
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from importlib import metadata
from typing import Any

from dynabot_mj.common.tables import aligned
from dynabot_mj.host.opengl import BACKENDS, MEND, has_display

_LONGEST = 120.0  # that a check may take [s]
_WIDEST = 90  # complaint of a process in the table
_EXTRAS = {"view": "mjviser", "cluster": "distributed"}  # and a module of each

_FRAME = """
import mujoco
model = mujoco.MjModel.from_xml_string(
    '<mujoco><worldbody><light pos="0 0 3"/><geom type="plane" size="1 1 1"/>'
    '<geom size="0.3" pos="0 0 0.3"/></worldbody></mujoco>'
)
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
with mujoco.Renderer(model, 48, 64) as renderer:
    renderer.update_scene(data)
    frame = renderer.render()
print("blank" if frame.min() == frame.max() else "drawn")
"""

_STEP = """
from dm_control import mujoco
physics = mujoco.Physics.from_xml_string("<mujoco/>")
physics.step()
"""

_FIGURE = """
import io
from matplotlib import pyplot
from dynabot_mj.figures import style
with pyplot.rc_context(style.STYLE):
    figure, axes = pyplot.subplots()
    axes.plot([0.0, 1.0], label="a")
    figure.savefig(io.BytesIO())
"""

_ENCODE = """
import subprocess, imageio_ffmpeg
encoder = imageio_ffmpeg.get_ffmpeg_exe()
source = ["-f", "lavfi", "-i", "color=size=64x48:duration=0.1"]
subprocess.run([encoder, "-v", "error", *source, "-c:v", "libx264", "-f", "null", "-"], check=True)
print(imageio_ffmpeg.get_ffmpeg_version())
"""


@dataclass(frozen=True, kw_only=True)
class Check:
    """One thing that was looked at."""

    name: str
    ok: bool
    found: str
    needed: bool  # whether something of ours fails without it
    mend: str | None = None  # what to do where it is not ok


def examine(cores: int, figures_asked: str | None = None) -> list[Check]:
    """Looks at everything.

    Args:
        cores: That this process may use.
        figures_asked: What MPLBACKEND is for other programs.
    """
    backends = [_backend(name) for name in BACKENDS]
    needed = [_graphics(backends), _encoder(), _figures(figures_asked), _mujoco(), _dm_control()]
    return [*backends, *needed, _processor(cores), *_extras()]


def failures(checks: Sequence[Check]) -> list[Check]:
    """Returns what has to be mended."""
    return [check for check in checks if check.needed and not check.ok]


def document(checks: Sequence[Check]) -> dict[str, Any]:
    """Returns the JSON document."""
    return {"healthy": not failures(checks), "checks": [asdict(check) for check in checks]}


def text(checks: Sequence[Check]) -> str:
    """Returns a table, and below it what to do."""

    def verdict(check: Check) -> str:
        if check.ok:
            return "yes"
        return "NO" if check.needed else "no"

    table = aligned(["what", "works", "found"], [[check.name, verdict(check), check.found] for check in checks])
    mended = [check for check in checks if not check.ok]
    if not mended:
        return "\n".join(table)
    width = max(len(check.name) for check in mended)
    advice = [f"{check.name.ljust(width)}  {check.mend}" for check in mended]
    title = "To mend (what is needed says NO above):" if failures(checks) else "Nothing more is needed. Optional:"
    return "\n".join([*table, "", title, *advice])


def _backend(name: str) -> Check:
    done = _run(_FRAME, MUJOCO_GL=name)
    drawn = done.returncode == 0 and done.stdout.strip() == "drawn"
    if done.returncode == 0:
        found = "a frame drawn" if drawn else "a blank frame"
    elif name == "glfw" and not has_display():
        found = "no display"
    elif "'NoneType' object has no attribute" in done.stderr:  # as PyOpenGL puts it
        found = "no library, or no driver"
    else:
        found = _reason(done)
    return Check(name=f"OpenGL {name}", ok=drawn, found=found, needed=False, mend=MEND[name])


def _graphics(backends: Sequence[Check]) -> Check:
    """Tells whether there is a back end to draw with: the one that was asked for, or any."""
    name, asked = "drawing without a display", os.environ.get("MUJOCO_GL", "").lower()
    working = [backend for backend, check in zip(BACKENDS, backends, strict=True) if check.ok]
    if asked:
        mend = f"unset MUJOCO_GL, or set it to {working[0]}" if working else MEND["egl"]
        return Check(name=name, ok=asked in working, found=f"MUJOCO_GL={asked}", needed=True, mend=mend)
    found = working[0] if working else "no OpenGL back end"
    return Check(name=name, ok=bool(working), found=found, needed=True, mend=MEND["egl"])


def _encoder() -> Check:
    done = _run(_ENCODE)
    ok = done.returncode == 0
    return Check(
        name="ffmpeg with H.264",
        ok=ok,
        found=done.stdout.strip() if ok else _reason(done),
        needed=True,
        mend="unset IMAGEIO_FFMPEG_EXE"
        if "IMAGEIO_FFMPEG_EXE" in os.environ
        else "pip install --force-reinstall imageio-ffmpeg",
    )


def _figures(asked: str | None) -> Check:
    """Draws a figure as commands do, which the user's own settings of Matplotlib must not disturb."""
    done = _run(_FIGURE, MPLBACKEND="agg")
    found = "a figure drawn" if done.returncode == 0 else _reason(done)
    if asked and asked != "agg":
        found += f"; by agg, not by MPLBACKEND={asked}"
    mend = "pip install --force-reinstall matplotlib"
    return Check(name="figures", ok=done.returncode == 0, found=found, needed=True, mend=mend)


def _mujoco() -> Check:
    version = metadata.version("mujoco")
    ok = (3, 17) <= tuple(int(part) for part in version.split(".")[:2]) < (4, 0)
    return Check(name="mujoco", ok=ok, found=version, needed=True, mend='pip install "mujoco>=3.17,<4"')


def _dm_control() -> Check:
    """Steps a model: what fits together is not told by the numbers of versions alone."""
    done = _run(_STEP, MUJOCO_GL="disable")
    found = metadata.version("dm_control") + ("" if done.returncode == 0 else f": {_reason(done)}")
    mend = 'pip install "mujoco>=3.17,<4" "dm-control>=1.0.50"'
    return Check(name="dm_control with it", ok=done.returncode == 0, found=found, needed=True, mend=mend)


def _processor(cores: int) -> Check:
    threads = os.environ.get("OMP_NUM_THREADS", "not set")
    found = f"{cores}, {platform.machine()}; OMP_NUM_THREADS {threads}; Python {platform.python_version()}"
    return Check(name="cores", ok=True, found=found, needed=False)


def _extras() -> list[Check]:
    return [
        Check(
            name=f"extra {extra}",
            ok=(ok := importlib.util.find_spec(module) is not None),
            found=f"{module} {metadata.version(module)}" if ok else f"no {module}",
            needed=False,
            mend=f'pip install "dynabot-mj[{extra}]"',
        )
        for extra, module in _EXTRAS.items()
    ]


def _run(code: str, **variables: str) -> subprocess.CompletedProcess[str]:
    """Runs Python code in a process of its own, which a broken driver may take down or hold up."""
    command = [sys.executable, "-c", code]
    # As commands do, whatever other programs are to bind.
    environment = {**{name: value for name, value in os.environ.items() if name != "PYOPENGL_PLATFORM"}, **variables}
    try:
        return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=_LONGEST, check=False)
    except subprocess.TimeoutExpired:
        return subprocess.CompletedProcess(command, 1, "", f"no answer within {_LONGEST:g} s")


def _reason(done: subprocess.CompletedProcess[str]) -> str:
    """Returns the last line that a process complained with."""
    lines = done.stderr.strip().splitlines()
    return textwrap.shorten(lines[-1], _WIDEST, placeholder=" ...") if lines else f"ended with code {done.returncode}"
