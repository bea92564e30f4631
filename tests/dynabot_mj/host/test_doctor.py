import json
import subprocess

import pytest

from dynabot_mj.host import doctor, opengl
from dynabot_mj.host.doctor import Check


@pytest.fixture
def answers(monkeypatch):
    """Lets the processes that checks start answer as told: by the back end, or by a word in their code."""

    def tell(**answers):
        def run(code, **variables):
            for word, (status, out, err) in answers.items():
                if word == variables.get("MUJOCO_GL") or word in code:
                    return subprocess.CompletedProcess([], status, out, err)
            return subprocess.CompletedProcess([], 1, "", "Traceback\nOSError: broken")

        monkeypatch.setattr(doctor, "_run", run)

    return tell


WORKING = {"imageio_ffmpeg": (0, "9.0\n", ""), "dm_control": (0, "", ""), "matplotlib": (0, "", "")}
DRAWN = (0, "drawn\n", "")


def found(checks):
    return {check.name: check for check in checks}


def test_without_graphics_it_says_what_to_install(without_graphics):
    checks = found(doctor.examine(cores=1))
    assert not any(checks[f"OpenGL {name}"].ok for name in opengl.BACKENDS)
    assert checks["OpenGL egl"].found == "no library, or no driver"
    assert checks["OpenGL glfw"].found == "no display"
    (failure,) = doctor.failures(list(checks.values()))
    assert (failure.name, failure.found) == ("drawing without a display", "no OpenGL back end")
    assert failure.mend.startswith("apt-get install libegl1")


def test_encoder_and_versions_work_here():
    checks = found(doctor.examine(cores=3, figures_asked="module://a_notebooks.own"))
    for name in ("ffmpeg with H.264", "figures", "mujoco", "dm_control with it"):
        assert checks[name].ok, checks[name].found
    assert checks["cores"].found.startswith("3, ")
    assert checks["figures"].found == "a figure drawn; by agg, not by MPLBACKEND=module://a_notebooks.own"


def test_bindings_that_other_programs_ask_for_do_not_disturb(monkeypatch):
    monkeypatch.setenv("PYOPENGL_PLATFORM", "glx")
    assert doctor._run("import os; print('PYOPENGL_PLATFORM' in os.environ)").stdout == "False\n"


@pytest.mark.parametrize(("asked", "healthy"), [(None, True), ("egl", False), ("osmesa", True), ("nonsense", False)])
def test_the_back_end_asked_for_is_what_counts(answers, monkeypatch, asked, healthy):
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    if asked:
        monkeypatch.setenv("MUJOCO_GL", asked)
    answers(osmesa=DRAWN, **WORKING)
    checks = doctor.examine(cores=1)
    assert doctor.document(checks)["healthy"] == healthy
    assert [check.mend for check in doctor.failures(checks)] == (
        [] if healthy else ["unset MUJOCO_GL, or set it to osmesa"]
    )


def test_a_blank_frame_is_none(answers, monkeypatch):
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    answers(egl=(0, "blank\n", ""), **WORKING)
    checks = doctor.examine(cores=1)
    assert found(checks)["OpenGL egl"].found == "a blank frame"
    assert len(doctor.failures(checks)) == 1


@pytest.mark.parametrize(
    ("broken", "name"),
    [("imageio_ffmpeg", "ffmpeg with H.264"), ("dm_control", "dm_control with it"), ("matplotlib", "figures")],
)
def test_what_is_needed_besides_graphics(answers, monkeypatch, broken, name):
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    answers(egl=DRAWN, **{key: value for key, value in WORKING.items() if key != broken})
    (failure,) = doctor.failures(doctor.examine(cores=1))
    assert failure.name == name
    assert "OSError: broken" in failure.found
    assert failure.mend.startswith(("pip install", "unset IMAGEIO_FFMPEG_EXE"))


@pytest.mark.parametrize(("version", "ok"), [("3.16.4", False), ("3.17.0", True), ("3.20.1", True), ("4.0.0", False)])
def test_versions_of_mujoco_that_fit(monkeypatch, version, ok):
    monkeypatch.setattr(doctor.metadata, "version", lambda name: version)
    assert doctor._mujoco().ok == ok


def test_an_encoder_that_is_not_there(monkeypatch, tmp_path):
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(tmp_path / "absent"))
    check = doctor._encoder()
    assert not check.ok
    assert check.mend == "unset IMAGEIO_FFMPEG_EXE"


def test_a_process_that_does_not_answer(monkeypatch):
    monkeypatch.setattr(doctor, "_LONGEST", 0.2)
    done = doctor._run("import time; time.sleep(60)")
    assert done.returncode != 0
    assert "no answer" in doctor._reason(done)


def test_text_and_document():
    checks = [
        Check(name="good", ok=True, found="yes, it is", needed=True),
        Check(name="bad", ok=False, found="gone", needed=True, mend="fetch it"),
        Check(name="optional", ok=False, found="absent", needed=False, mend="install it"),
    ]
    text = doctor.text(checks)
    assert "| bad      | NO    | gone" in text
    assert "| optional | no    | absent" in text
    assert text.splitlines()[-2:] == ["bad       fetch it", "optional  install it"]
    assert "To mend" not in doctor.text(checks[:1])
    document = doctor.document(checks)
    assert json.loads(json.dumps(document)) == document
    assert not document["healthy"]
    assert doctor.document(checks[::2])["healthy"]
