"""The command on real trials: what the files hold is read back."""

import gc
import json
import os
import signal
import subprocess
import sys

import imageio.v3 as imageio
import numpy as np
import pytest
from PIL import Image

from dynabot_mj import study
from dynabot_mj.common.legend import ROBOT_COLOURS, rgb

SMALL = ["--size", "480x272", "--rate", "10"]

# imageio leaves the pipes of its reader open.
pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
drawn = pytest.mark.usefixtures("graphics")


@pytest.fixture(autouse=True)
def pipes_are_collected_here():
    yield
    gc.collect()


def coloured(frame, robot):
    """Returns how many pixels have a robot's colour."""
    return int((np.abs(frame - 255.0 * np.array(rgb(ROBOT_COLOURS[robot]))).max(axis=-1) < 40).sum())


@drawn
def test_a_video_is_as_long_as_its_trial_and_robots_move_and_trails_grow(dynabot, tmp_path):
    path = tmp_path / "new" / "f.mp4"
    what = ["--plant", "rigid", "--estimator", "decoupled", "--duration", "5"]
    done = dynabot("video", *what, "--camera", "top", "--rate", "10", "--out", path, "--json")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    about = imageio.immeta(path, plugin="FFMPEG")
    assert about["codec"] == "h264"
    assert about["size"] == (1280, 720)
    assert about["duration"] == pytest.approx(5.0, abs=0.05)
    frames = imageio.imread(path, plugin="FFMPEG").astype(int)
    assert len(frames) == told["frames"] == 50
    for frame in frames[::10]:
        for part in np.array_split(frame[:-80], 3):
            assert part.std() > 1.0
    assert (np.abs(frames[0, :-80] - frames[-1, :-80]).max(axis=-1) > 60).sum() > 300
    for robot in range(3):
        assert coloured(frames[-1, :-80], robot) > coloured(frames[1, :-80], robot) > 20
    assert [file.name for file in path.parent.iterdir()] == ["f.mp4"]


@drawn
def test_a_saved_trial_is_filmed_as_the_study_ran_it(main, dataset, tmp_path):
    study.save(dataset, tmp_path / "study.nc")
    line = ["--reproduce", f"{tmp_path}:rigid/gauss-markov/gps:2", "--speed", "4", *SMALL, "--out", tmp_path / "a.gif"]
    done = main("video", *line, "--beside", "particle", "--eyes-of", "1")
    assert done.returncode == 0, done.stderr
    with Image.open(tmp_path / "a.gif") as animation:
        assert animation.size == (480, 272)
        assert animation.n_frames * 0.1 == pytest.approx(3.5)
        assert animation.info["duration"] == 100


@drawn
def test_a_still_is_the_frame_of_its_instant(main, tmp_path):
    line = ["video", "--plant", "particle", "--duration", "3", "--size", "480x272"]
    assert main(*line, "--rate", "10", "--out", tmp_path / "a.mp4").returncode == 0
    assert main(*line, "--still", "2", "--out", tmp_path / "a.png").returncode == 0
    still = imageio.imread(tmp_path / "a.png").astype(int)
    frame = imageio.imread(tmp_path / "a.mp4", plugin="FFMPEG", index=20).astype(int)
    assert still.shape == frame.shape == (272, 480, 3)
    assert np.abs(still - frame).mean() < 4.0


@drawn
@pytest.mark.parametrize(("instant", "at"), [("0", 0.0), ("0.01", 0.0), ("1.2345", 1.2345), ("3", 3.0)])
def test_a_still_is_of_the_instant_that_was_asked_for(main, tmp_path, instant, at):
    line = ["video", "--plant", "particle", "--duration", "3", "--size", "480x272", "--still", instant, "--json"]
    done = main(*line, "--out", tmp_path / "a.png")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["time_s"] == pytest.approx(at, abs=1e-9)


@drawn
def test_ctrl_c_while_it_is_drawn_is_one_line_and_leaves_nothing(started, polled, tmp_path):
    process = started("video", "--duration", "80", "--out", tmp_path / "a.mp4")
    assert polled(lambda: list(tmp_path.glob(".partial-*.mp4")))
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=240)
    assert process.returncode == 130
    assert out == ""
    assert err.splitlines()[-1] == "dynabot: interrupted"
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []


@drawn
@pytest.mark.slow
def test_memory_does_not_grow_with_the_length(command, tmp_path):
    """Holding the frames would take 140 MB for 20 s and 560 MB for 80 s, beside about 300 MB for all else."""
    measure = (
        "import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True, capture_output=True);"
        "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
    )
    peaks = []
    for duration in (20, 80):
        line = [command, "video", "--duration", duration, "--size", "640x360", "--rate", "10"]
        line = [sys.executable, "-c", measure, *line, "--out", tmp_path / "a.mp4"]
        done = subprocess.run(list(map(str, line)), capture_output=True, text=True, timeout=300, check=True)
        peaks.append(int(done.stdout))
    assert peaks[1] < 1.2 * peaks[0]


def test_without_a_library_the_package_is_named_and_nothing_is_written(command, tmp_path, without_graphics):
    line = [command, "video", "--duration", "1", "--out", tmp_path / "out" / "a.mp4"]
    done = subprocess.run(line, capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 1
    assert done.stderr.startswith("dynabot: no OpenGL library to draw with: apt-get install libegl1 libgl1-mesa-dri")
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_without_a_library_everything_else_works(command, tmp_path, without_graphics):
    """`doctor` too, but that the next test asks."""

    def run(*line):
        line = list(map(str, [command, *line]))
        return subprocess.run(line, capture_output=True, text=True, timeout=300, check=False, cwd=tmp_path)

    line = ["--trials", "1", "--duration", "1", "--estimators", "gps", "--plants", "rigid", "--workers", "1"]
    done = run("compare", *line, "--out", tmp_path / "c")
    assert done.returncode == 0, done.stderr
    done = run("report", tmp_path / "c")
    assert done.returncode == 0, done.stderr
    assert "there is no film: no OpenGL library to draw with: apt-get install libegl1" in done.stdout
    code = "from dynabot_mj import environment; environment.load().reset(); print('reset')"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=240, check=True)
    assert (done.stdout, done.stderr) == ("reset\n", "")


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ("osmesa", "OpenGL osmesa does not work"),
        pytest.param("glfw", "OpenGL glfw does not work", marks=pytest.mark.slow),
        pytest.param(
            "nonsense",
            "MUJOCO_GL=nonsense cannot draw; unset it, or set it to one of egl, osmesa, glfw",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_a_back_end_that_is_not_there_keeps_nothing_but_pictures(command, tmp_path, without_graphics, asked, told):
    def run(*line):
        environment = {**os.environ, "MUJOCO_GL": asked}
        line = list(map(str, [command, *line]))
        return subprocess.run(line, capture_output=True, text=True, timeout=300, check=False, env=environment)

    done = run("video", "--duration", "0.2", "--out", tmp_path / "out" / "a.mp4")
    assert done.returncode == 1
    assert done.stderr.startswith(f"dynabot: {told}")
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists() or list((tmp_path / "out").iterdir()) == []
    line = ["--trials", "1", "--duration", "1", "--plants", "particle", "--estimators", "perfect", "gps"]
    assert run("compare", *line, "--workers", "2", "--out", tmp_path / "c").returncode == 0
    done = run("doctor")
    assert done.returncode == 1
    assert f"MUJOCO_GL={asked}" in done.stdout
    assert "apt-get install libegl1 libgl1-mesa-dri" in done.stderr


@drawn
def test_the_environments_pictures_need_no_display_either():
    environment = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "MUJOCO_GL")}
    code = (
        "from dynabot_mj import environment; env = environment.load(); env.reset();"
        "picture = env.physics.render(48, 64); print(picture.shape, picture.std() > 1)"
    )
    line = [sys.executable, "-c", code]
    done = subprocess.run(line, capture_output=True, text=True, timeout=240, check=True, env=environment)
    assert (done.stdout, done.stderr) == ("(48, 64, 3) True\n", "")


@drawn
@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--out", "a.avi"], "--out a.avi given, it must be a file whose name ends with .mp4 or .gif"),
        (["--out", "."], "--out . given, it is a folder"),
        (["--still", "1", "--out", "a.mp4"], "--out a.mp4 given, it must be a file whose name ends with .png"),
        (["--still", "-1"], "--still -1 given, the trial lasts from 0 to 80 s"),
        (["--still", "nan"], "--still nan given, the trial lasts from 0 to 80 s"),
        (["--speed", "0"], "--speed 0 given, allowed are 0.01 to 100 for .mp4"),
        (["--speed", "nan"], "--speed nan given, allowed are 0.01 to 100 for .mp4"),
        (
            ["--speed", "100", "--duration", "2"],
            "a trial of 2 s at --speed 100 and --rate 30 is a single frame; --still makes one",
        ),
        (["--rate", "1000"], "--rate 1000 given, allowed are 1 to 120 for .mp4"),
        (["--rate", "60", "--out", "a.gif"], "--rate 60 given, allowed are 1 to 50 for .gif"),
        (["--rate", "60", "--still", "1"], "--rate given with --still, which is one picture"),
        (["--eyes-of", "4"], "--eyes-of 4 given, the robots are 1 to 3"),
        (["--eyes-of", "1", "--hide", "beliefs"], "--eyes-of given with --hide beliefs, which hides what it shows"),
        (["--follow", "1"], "--follow given with --camera orbit; it is the camera chase that follows a robot"),
        (
            ["--beside", "particle", "--plant", "particle"],
            "--beside particle given with --plant particle",
        ),
        (
            ["--size", "721x500"],
            "argument --size: '721x500' given, it must be e.g. 1280x720: even",
        ),
        (["--size", "large"], "argument --size: 'large' given, it must be e.g. 1280x720: even numbers from 480x270"),
    ],
)
def test_bad_input_is_told_in_one_line(main, options, told, tmp_path):
    done = main("video", *options, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith(f"dynabot: {told}")
    assert done.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
