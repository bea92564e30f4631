"""The command line through its real entry point."""

import importlib
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import dynabot_mj
from dynabot_mj import cli
from dynabot_mj.commands import compare

NONSENSE = [
    (["compare", "--robots", "0"], "--robots 0: input should be greater than or equal to 2"),
    (["compare", "--robots", "9"], "--robots 9"),
    (["compare", "--trials", "-1"], "--trials -1"),
    (["compare", "--trials", "x"], "invalid int value: 'x'"),
    (["compare", "--estimators", "foo"], "--estimators 'foo' given, it must be one of perfect, gps,"),
    (["compare", "--estimators"], "expected at least one argument"),
    (["compare", "--duration", "nan"], "--duration nan"),
    (["compare", "--seed", "-1"], "--seed -1"),
    (["compare", "--workers", "0"], "--workers 0 given"),
    (["compare", "--utilisation", "0.1"], "the utilisation bound is 0.1"),
    (["compare", "--bogus"], "unrecognized arguments: --bogus"),
    (
        ["compare", "--trial", "7"],
        "unrecognized arguments: --trial 7; did you mean --trials? (see dynabot compare --help)",
    ),
    (["run", "--estimato", "gps"], "did you mean --estimator? (see dynabot run --help)"),
    (
        ["compare", "--estimators", "decopled"],
        "--estimators 'decopled' given, it must be one of perfect, gps, decoupled, coupled, or a method",
    ),
    (["compare", "--utilisation", "95"], "a fraction is meant: 0.95?"),
    (["compare", "--config", "misspelt.toml"], "unknown key radio.mesage_bytes; did you mean radio.message_bytes?"),
    (["compare", "--config", "nested.toml"], "brackets are nested too deeply"),
    (["compare", "--config", "nameless.toml"], "unknown key ''"),
    (["compare", "--config", "unknown.toml"], "unknown key bogus"),
    (["compare", "--config", "type.toml"], "trials = 'many'"),
    (["compare", "--config", "mass.toml"], "mass = -12: input should be greater than 0 kg"),
    (["compare", "--config", "light.toml"], "mass = 10 kg given; with the rigid plant"),
    (["compare", "--config", "binary.toml"], "not a text file"),
    (["compare", "--config", "absent.toml"], "No such file"),
    (["compare", "--config", "."], "Is a directory"),
    (["compare", "--out", "unknown.toml/below"], "cannot write to the folder"),
    (["run", "--reproduce", "nothing"], "it must be STUDY:CASE:TRIAL"),
    (["run", "--reproduce", "nothing:rigid/perfect:0"], "there is no study at nothing"),
    (["run", "--reproduce", "nothing:rigid/perfect:0", "--seed", "5"], "--seed given with --reproduce"),
    (["run", "--config", "several.toml"], "particle, rigid given by several.toml; run takes one: choose with --plant"),
    (["compare", "--out", ""], "an empty name given"),
    (["run", "--trial", "-1"], "--trial -1"),
    (["schedule", "--utilisation", "1.7"], "utilisation 1.7 given, allowed is 0 < U <= 1"),
    (["schedule", "--utilisation", "nan"], "allowed is 0 < U <= 1"),
    (["schedule", "--utilisation", "0.1"], "GPS parsing alone"),
    (["schedule", "--robots", "8"], "8 robots given, allowed are 2 to 7"),
    (["drive", "--friction", "0.01"], "--friction 0.01 given, allowed are 0.05 to 1.5"),
    (["drive", "--friction", "nan"], "allowed are 0.05 to 1.5"),
    (["drive", "--friction", "slippery"], "invalid float value: 'slippery'"),
    (["drive", "--payload", "-1"], "--payload -1 given, allowed are 0 to 100 kg"),
    (["drive", "--payload", "inf"], "allowed are 0 to 100 kg"),
    (["drive", "--model", "absent.xml"], "it must be 'dynabot' or an MJCF file"),
    (["drive", "--model", "type.toml"], "cannot be read"),
    (["drive", "--slope", "0.1"], "unrecognized arguments: --slope"),
    (["drive", "--out", "unknown.toml/below"], "cannot write to the folder"),
    (["compare", "--friction", "0.9..0.3"], "--friction 0.9..0.3 given, the first must not be above"),
    (["compare", "--friction", "0.3..x"], "'0.3..x' given, it must be a number such as 0.75 or a range such as"),
    (["compare", "--slope", "2"], "--slope 2"),
    (["compare", "--payload", "-1"], "--payload -1: input should be greater than or equal to 0 kg"),
    (["compare", "--gains", "bogus"], "gains 'bogus' given, it must be a gain file or one of: first, "),
    (["compare", "--gains", "bogus", "--plants", "particle"], "gains 'bogus' given, it must be a gain file or one of"),
    (["compare", "--duration", "80000"], "--duration 80000: input should be less than or equal to 10000 s"),
    (["compare", "--payload", "4000"], "--payload 4000 given, it must be at most 100 kg; is 4 meant?"),
    (["compare", "--friction", "0.3..90"], "--friction 90: input should be less than or equal to 1.5"),
    (["run", "--plant", "particle", "--friction", "0.5"], "--friction given, but the study has point masses alone"),
    (["compare", "--plants", "particle", "--steering", "heading"], "--steering given, but the study has point masses"),
    (["video", "--plant", "particle", "--sensing", "truth"], "--sensing given, but the study has point masses"),
    (["view", "--plant", "particle", "--gains", "first"], "--gains given, but the study has point masses"),
    (["compare", "--plants", "particle", "--headings", "leader"], "--headings given, but the study has point masses"),
    (["compare", "--plants", "particle", "--threads", "2"], "--threads 2 given, but they are MuJoCo's"),
    (["run", "--filters", "filterpy"], "--filters given, but the study has no perception filter"),
    (["run", "--estimator", "perfect", "--perception", "filter"], "--perception given, but the study is of perfect"),
    (["run", "--estimator", "perfect", "--utilisation", "0.9"], "--utilisation given, but the study is of perfect"),
    (["run", "--workers", "8"], "unrecognized arguments: --workers 8"),
    (["compare", "--workers", "2", "--scheduler", "x"], "--workers 2 given with --scheduler"),
    (["compare", "--overwrite"], "--overwrite given without --out: out/compare is replaced without it"),
    (["run", "--out", "dangling"], "it is a link to nowhere, which is not there"),
    (["run", "--out", "x" * 300], "File name too long"),
    (["report", "x" * 300], "File name too long"),
    (["power", "nothing"], "the following arguments are required: --cases, --measure (see dynabot power --help)"),
    (["power", "nothing", "--cases", "a", "b", "--measure", "arrival_s"], "there is no study at nothing"),
    (["video", "--out", f"{'x' * 300}.mp4"], "File name too long"),
    (["compare", "--gains", "type.toml"], "the gain file type.toml must have a table hand_point with just these keys"),
    (["run", "--reproduce", "nothing:rigid/perfect:0", "--friction", "0.5"], "--friction given with --reproduce"),
    ([], "required"),
    (["bogus"], "invalid choice: 'bogus'"),
]


@pytest.mark.parametrize(
    ("arguments", "message"), NONSENSE, ids=lambda value: " ".join(value) if isinstance(value, list) else ""
)
def test_nonsense_is_one_line_and_code_2_before_any_work(main, arguments, message, tmp_path):
    (tmp_path / "unknown.toml").write_text("bogus = 1")
    (tmp_path / "type.toml").write_text("trials = 'many'")
    (tmp_path / "mass.toml").write_text("mass = -12.0")
    (tmp_path / "several.toml").write_text("plants = ['particle', 'rigid']")
    (tmp_path / "light.toml").write_text("mass = 10.0")
    (tmp_path / "misspelt.toml").write_text("[radio]\nmesage_bytes = 3")
    (tmp_path / "nested.toml").write_text(f"robots = {'[' * 3000}{']' * 3000}")
    (tmp_path / "nameless.toml").write_text('"" = 1')
    (tmp_path / "binary.toml").write_bytes(bytes(range(128, 256)))
    (tmp_path / "dangling").symlink_to("nowhere")
    before = sorted(tmp_path.iterdir())
    done = main(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert done.stdout == ""
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("arguments", [[], ["compare", "--robots", "0"]])
def test_nonsense_is_one_line_and_code_2_of_the_process(dynabot, main, arguments, tmp_path):
    done, here = dynabot(*arguments, cwd=tmp_path), main(*arguments)
    assert (done.returncode, done.stdout, done.stderr) == (2, "", here.stderr)


@pytest.mark.parametrize("delay", [0.0, 0.5, 1.5])
def test_ctrl_c_while_the_workers_start_is_one_line(started, delay, tmp_path):
    line = ["compare", "--trials", "300", "--plants", "particle", "--workers", "2", "--out", tmp_path / "x"]
    process = started(*line)
    # The study is announced by a note on its periods; until then a busy machine may still be importing.
    assert process.stderr.readline().startswith("note:")
    time.sleep(delay)
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=240)
    assert process.returncode == 130
    (told,) = [line for line in err.splitlines() if not line.startswith(("note:", "compare:"))]
    assert re.fullmatch(r"dynabot: interrupted(; kept \d+ of \d+ parts, --resume continues from them)?", told)


def test_an_interrupted_import_is_an_interruption(main, monkeypatch):
    def interrupted(commands):
        try:
            raise KeyboardInterrupt
        except KeyboardInterrupt as error:
            raise ImportError("initialization failed") from error

    monkeypatch.setattr(compare, "add", interrupted)
    done = main("compare")
    assert (done.returncode, done.stderr) == (130, "dynabot: interrupted\n")


HEAVY = {"casadi", "dm_control", "matplotlib", "mujoco", "numpy", "pydantic", "scipy", "xarray"}
TELL = "import atexit, sys; atexit.register(lambda: print(*sys.modules, file=sys.stderr)); "


def imported(code):
    """Returns all modules that a fresh interpreter has imported when it ends."""
    # Where it is set, commands import MuJoCo before anything else.
    environment = {name: value for name, value in os.environ.items() if name != "MUJOCO_GL"}
    line = [sys.executable, "-c", TELL + code]
    done = subprocess.run(line, capture_output=True, text=True, check=False, env=environment)
    return set(done.stderr.splitlines()[-1].split())


def test_importing_the_package_imports_nothing_heavy():
    assert not HEAVY & imported("import dynabot_mj")


@pytest.mark.parametrize("line", [["--help"], ["--version"], [], ["bogus"], ["doctor", "--help"]], ids=" ".join)
def test_what_is_told_without_a_study_imports_nothing_heavy(line):
    found = imported(f"from dynabot_mj import cli; cli.main({line})")
    assert "dynabot_mj.cli" in found
    assert not HEAVY & found


def test_only_the_command_that_is_typed_is_imported():
    found = imported("from dynabot_mj import cli; cli.main(['schedule'])")
    assert found & {f"dynabot_mj.commands.{name}" for name in cli._COMMANDS} == {"dynabot_mj.commands.schedule"}
    assert not {"matplotlib", "mujoco", "pydantic"} & found


def test_a_back_end_that_is_not_there_stops_no_command_that_imports_mujoco_late(command):
    line, environment = [command, "drive", "--model", "absent.xml"], {**os.environ, "MUJOCO_GL": "nonsense"}
    done = subprocess.run(line, capture_output=True, text=True, check=False, env=environment)
    assert done.returncode == 2
    assert "it must be 'dynabot' or an MJCF file" in done.stderr


def test_commands_are_listed_as_they_tell_themselves():
    files = {path.stem for path in Path(cli.__file__).with_name("commands").glob("*.py")}
    modules = {name: importlib.import_module(f"dynabot_mj.commands.{name}") for name in files}
    told = {name: getattr(module, name).__doc__ for name, module in modules.items() if hasattr(module, "add")}
    assert told == cli._COMMANDS


def test_version_and_module_entry_point(dynabot):
    assert dynabot("--version").stdout.strip() == f"dynabot-mj {dynabot_mj.__version__}"
    done = subprocess.run([sys.executable, "-m", "dynabot_mj", "--help"], capture_output=True, text=True, check=False)
    assert done.returncode == 0
    assert "compare" in done.stdout


SHORT = ["run", "--plant", "particle", "--estimator", "gps", "--duration", "14", "--out"]


# Two at a time: none of a pair hides what another one breaks.
@pytest.mark.parametrize(
    "surroundings",
    [
        {"PYTHONIOENCODING": "ascii", "MPLBACKEND": "module://a_notebooks.own"},
        {"PYTHONUTF8": "0", "PYTHONIOENCODING": "cp1252", "MATPLOTLIBRC": "."},
    ],
    ids=" ".join,
)
def test_what_surrounds_us_does_not_stop_us(command, surroundings, tmp_path):
    (tmp_path / "matplotlibrc").write_text("text.usetex: True\nfont.family: no such one\n")
    line = [command, *SHORT, "out"]
    done = subprocess.run(
        line, capture_output=True, timeout=300, cwd=tmp_path, env={**os.environ, **surroundings}, check=False
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "trajectories.png").is_file()


def test_a_byte_order_mark_is_no_part_of_a_configuration(main, tmp_path):
    (tmp_path / "marked.toml").write_bytes(b"\xef\xbb\xbfseed = 5\n")
    done = main(*SHORT, tmp_path / "out", "--config", tmp_path / "marked.toml")
    assert done.returncode == 0, done.stderr
    assert "seed 5" in done.stdout


def test_a_law_that_prints_does_not_spoil_the_document(dynabot, tmp_path):
    (tmp_path / "loud.py").write_text("print('hello')\ndef law(known):\n    print('!')\n    return -known.position_w\n")
    done = dynabot(*SHORT, "out", "--json", "--controller", "loud:law", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["plant"] == "particle"
    assert "hello" in done.stderr
