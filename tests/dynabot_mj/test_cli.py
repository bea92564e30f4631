"""The command line through its real entry point."""

import json
import os
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import pytest

import dynabot_mj
import models
from controllers import gains

COMMAND = Path(sys.executable).parent / "dynabot"


def dynabot(*arguments, cwd=None):
    command = [COMMAND, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, cwd=cwd, check=False)


def test_schedule_prints_one_json_document():
    done = dynabot("schedule", "--json")
    assert done.returncode == 0
    document = json.loads(done.stdout)
    assert (document["robots"], document["utilisation"]) == (3, 1.0)
    rows = {row["estimator"]: row for row in document["rows"]}
    assert {name: row["period_ms"] for name, row in rows.items()} == {"gps": 27, "decoupled": 36, "coupled": 156}
    assert rows["coupled"]["period_exact_ms"] == pytest.approx(155.98, abs=0.005)
    # Judged before rounding: worth a word, not an error.
    assert "rounded periods of gps load the processor 1.0015" in done.stderr


@pytest.mark.parametrize("robots", range(2, 8))
def test_schedule_serves_every_fleet(robots):
    rows = json.loads(dynabot("schedule", "--json", "--robots", robots).stdout)["rows"]
    assert rows[0]["period_ms"] < rows[1]["period_ms"] < rows[2]["period_ms"]


def test_compare_writes_results_that_can_be_fed_back_in(tmp_path):
    first = dynabot("compare", "--trials", 2, "--duration", 14, "--seed", 3, "--json", "--out", tmp_path / "a")
    assert first.returncode == 0, first.stderr
    document = json.loads(first.stdout)
    assert len(document["rows"]) == 8
    assert document["wall_s"] > 0
    names = {file.name for file in (tmp_path / "a").iterdir() if not file.name.startswith(".")}
    assert names == {
        "study.nc", "study.toml", "execution.json", "table.md", "compare.json", "table_iii.png",
        "trajectories_perfect.png", "trajectories_gps.png", "trajectories_decoupled.png", "trajectories_coupled.png",
    }  # fmt: skip
    again = dynabot(
        "compare",
        "--config",
        tmp_path / "a" / "study.toml",
        "--threads",
        2,
        "--workers",
        1,
        "--json",
        "--out",
        tmp_path / "b",
    )
    assert (tmp_path / "a" / "study.nc").read_bytes() == (tmp_path / "b" / "study.nc").read_bytes()
    assert {**json.loads(again.stdout), "wall_s": 0} == {**document, "wall_s": 0}
    text = dynabot("compare", "--config", tmp_path / "a" / "study.toml", "--out", tmp_path / "b")
    assert "| decoupled" in text.stdout
    assert str(tmp_path / "b") in text.stdout


def test_run_prints_one_row_and_reproduces_a_trial_of_a_study(tmp_path):
    dynabot("compare", "--trials", 3, "--duration", 14, "--estimators", "gps", "--out", tmp_path / "study")
    done = dynabot(
        "run", "--reproduce", f"{tmp_path / 'study'}:rigid/gauss-markov/gps:2", "--json", "--out", tmp_path / "a"
    )
    assert done.returncode == 0, done.stderr
    fed_back = dynabot("run", "--config", tmp_path / "a" / "study.toml", "--json", "--out", tmp_path / "c")
    assert fed_back.stdout == done.stdout
    assert (tmp_path / "c" / "study.nc").read_bytes() == (tmp_path / "a" / "study.nc").read_bytes()
    fresh = dynabot("run", "--estimator", "gps", "--trial", 2, "--duration", 14, "--json", "--out", tmp_path / "b")
    assert done.stdout == fresh.stdout
    row = json.loads(done.stdout)
    assert (row["plant"], row["estimator"], row["trials"]) == ("rigid", "gps", 1)
    assert len(row["final_position_m"]) == 3
    assert (tmp_path / "a" / "trajectories.png").is_file()


def test_drive_prints_one_json_document_and_writes_its_results(tmp_path):
    done = dynabot("drive", "--json", "--out", tmp_path / "a")
    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout)
    assert 10.0 <= document["top_speed_mps"] <= 10.6
    assert 0.48 <= document["peak_acceleration_g"] <= 0.55
    assert set(document["turn_rate_over_theory"]) == {"10", "20", "40"}
    assert document["energy_gain_steps"] == 0
    assert {"airborne_fraction", "drift_mm_per_m", "heading_spread", "cornering", "collision"} < set(document)
    names = {file.name for file in (tmp_path / "a").iterdir() if not file.name.startswith(".")}
    assert names == {"drive.json", "drive.md", "drive.png"}
    assert json.loads((tmp_path / "a" / "drive.json").read_text()) == document


def test_drive_takes_another_ground_load_and_robot(tmp_path):
    robot = models.path("dynabot.xml").read_text(encoding="utf-8").replace('mass="0.6" euler', 'mass="1.2" euler')
    (tmp_path / "heavy.xml").write_text(robot, encoding="utf-8")
    options = ["--friction", 0.3, "--payload", 4, "--model", tmp_path / "heavy.xml"]
    done = dynabot("drive", *options, "--out", tmp_path / "a")
    assert done.returncode == 0, done.stderr
    assert "18.4 kg, friction 0.3" in done.stdout
    assert "| top speed" in done.stdout
    assert "band" not in done.stdout  # the acceptance is of the robot as it is
    document = json.loads((tmp_path / "a" / "drive.json").read_text())
    assert document["peak_deceleration_g"] == pytest.approx(0.3, rel=0.05)
    assert document["payload_kg"] == 4.0


def test_runs_take_another_ground_load_and_laws(tmp_path):
    options = ["--estimator", "gps", "--duration", 3, "--friction", "0.3..0.9", "--slope", 0.05, "--payload", 2]
    options += ["--steering", "heading", "--sensing", "truth", "--gains", "first", "--seed", 4, "--trial", 5]
    one, again = (dynabot("run", *options, "--json", "--out", tmp_path / name) for name in "ab")
    assert one.returncode == 0, one.stderr
    assert one.stdout == again.stdout
    table = tomllib.loads((tmp_path / "a" / "study.toml").read_text())["vehicle"]
    assert table == {
        "model": "dynabot", "friction": [0.3, 0.9], "slope": 0.05, "payload": 2.0, "steering": "heading",
        "sensing": "truth", "gains": "first",
    }  # fmt: skip
    # The trial's own friction alone differs in another trial's draw from the same range.
    options[options.index("0.3..0.9")] = "0.3..0.31"
    assert dynabot("run", *options, "--json", "--out", tmp_path / "c").stdout != one.stdout


def test_a_trial_is_reproduced_only_with_the_gains_of_its_study(tmp_path):
    gain_file = tmp_path / "mine.toml"
    text = gains.path("first").read_text(encoding="utf-8")
    gain_file.write_text(text, encoding="utf-8")
    options = ["--estimator", "gps", "--duration", 2, "--gains", gain_file]
    first = dynabot("run", *options, "--json", "--out", tmp_path / "a")
    assert first.returncode == 0, first.stderr
    reproduce = ["run", "--reproduce", f"{tmp_path / 'a'}:rigid/gauss-markov/gps:0", "--json", "--out", tmp_path / "b"]
    assert dynabot(*reproduce).stdout == first.stdout
    gain_file.write_text(text.replace("hold = 1.5", "hold = 1.6"), encoding="utf-8")
    done = dynabot(*reproduce)
    assert done.returncode == 2
    assert done.stderr.startswith(
        f"dynabot: the gains '{gain_file}' of {tmp_path / 'a' / 'study.nc'} has changed since"
    )
    assert len(done.stderr.splitlines()) == 1
    gain_file.unlink()
    done = dynabot(*reproduce)
    assert done.returncode == 2
    assert "it must be a gain file or one of" in done.stderr


NONSENSE = [
    (["compare", "--robots", "0"], "robots = 0"),
    (["compare", "--robots", "9"], "robots = 9"),
    (["compare", "--trials", "-1"], "trials = -1"),
    (["compare", "--trials", "x"], "invalid int value: 'x'"),
    (["compare", "--estimators", "foo"], "invalid choice: 'foo'"),
    (["compare", "--estimators"], "expected at least one argument"),
    (["compare", "--duration", "nan"], "duration = nan"),
    (["compare", "--seed", "-1"], "seed = -1"),
    (["compare", "--workers", "0"], "--workers 0 given"),
    (["compare", "--utilisation", "0.1"], "the utilisation bound is 0.1"),
    (["compare", "--bogus"], "unrecognized arguments: --bogus"),
    (["compare", "--config", "unknown.toml"], "unknown key bogus"),
    (["compare", "--config", "type.toml"], "trials = 'many'"),
    (["compare", "--config", "mass.toml"], "mass = -12.0"),
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
    (["run", "--trial", "-1"], "first_trial = -1"),
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
    (["compare", "--friction", "0.9..0.3"], "vehicle.friction = 0.9..0.3 given, the first must not be above"),
    (["compare", "--friction", "0.3..x"], "'0.3..x' given, it must be a number such as 0.75 or a range such as"),
    (["compare", "--slope", "2"], "vehicle.slope = 2"),
    (["compare", "--payload", "-1"], "vehicle.payload = -1"),
    (["compare", "--gains", "bogus"], "gains 'bogus' given, it must be a gain file or one of: first, "),
    (["compare", "--gains", "bogus", "--plants", "particle"], "gains 'bogus' given, it must be a gain file or one of"),
    (["compare", "--gains", "type.toml"], "the gain file type.toml must have a table hand_point with just these keys"),
    (["run", "--reproduce", "nothing:rigid/perfect:0", "--friction", "0.5"], "--friction given with --reproduce"),
    ([], "required"),
    (["bogus"], "invalid choice: 'bogus'"),
]


@pytest.mark.parametrize(
    ("arguments", "message"), NONSENSE, ids=lambda value: " ".join(value) if isinstance(value, list) else ""
)
def test_nonsense_is_one_line_and_code_2_before_any_work(arguments, message, tmp_path):
    (tmp_path / "unknown.toml").write_text("bogus = 1")
    (tmp_path / "type.toml").write_text("trials = 'many'")
    (tmp_path / "mass.toml").write_text("mass = -12.0")
    (tmp_path / "several.toml").write_text("plants = ['particle', 'rigid']")
    (tmp_path / "light.toml").write_text("mass = 10.0")
    (tmp_path / "binary.toml").write_bytes(bytes(range(128, 256)))
    before = sorted(tmp_path.iterdir())
    done = dynabot(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert done.stdout == ""
    assert sorted(tmp_path.iterdir()) == before


def test_ctrl_c_keeps_finished_parts_and_resume_continues(tmp_path):
    options = ["--trials", "120", "--duration", "30", "--plants", "particle", "--workers", "2", "--out", str(tmp_path)]
    process = subprocess.Popen(
        [COMMAND, "compare", *options],
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,  # a terminal's Ctrl-C reaches every process of the group
    )
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline and not list(tmp_path.glob(".chunks/*.pickle")):
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 1
    assert err.splitlines()[-1].startswith("dynabot: interrupted")
    assert "Traceback" not in err
    assert out == ""
    assert [path.name for path in tmp_path.iterdir()] == [".chunks"]
    assert not [path for path in tmp_path.rglob("*") if "partial" in path.name]
    resumed = dynabot("compare", *options, "--resume")
    assert resumed.returncode == 0
    assert not (tmp_path / ".chunks").exists()


@pytest.mark.parametrize("delay", [1.0, 2.0, 3.0])
def test_ctrl_c_while_the_workers_start_is_one_line(delay, tmp_path):
    command = [
        COMMAND,
        "compare",
        "--trials",
        "300",
        "--plants",
        "particle",
        "--workers",
        "2",
        "--out",
        str(tmp_path / "x"),
    ]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True)
    time.sleep(delay)
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 1
    assert [line for line in err.splitlines() if not line.startswith(("note:", "compare:"))] == [
        "dynabot: interrupted; --resume continues from what was finished"
    ]


def test_importing_the_package_imports_nothing_heavy():
    code = "import sys, dynabot_mj; sys.exit(any(name in sys.modules for name in ('numpy', 'mujoco', 'matplotlib')))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_version_and_module_entry_point():
    assert dynabot("--version").stdout.strip() == f"dynabot-mj {dynabot_mj.__version__}"
    done = subprocess.run([sys.executable, "-m", "dynabot_mj", "--help"], capture_output=True, text=True, check=False)
    assert done.returncode == 0
    assert "compare" in done.stdout
