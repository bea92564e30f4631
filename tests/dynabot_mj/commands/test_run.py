import json
import tomllib

from dynabot_mj import study
from dynabot_mj.controllers import gains


def test_run_prints_one_row_and_reproduces_a_trial_of_a_study(dynabot, main, dataset, tmp_path):
    (tmp_path / "study").mkdir()
    study.save(dataset, tmp_path / "study" / "study.nc")
    done = dynabot(
        "run", "--reproduce", f"{tmp_path / 'study'}:rigid/gauss-markov/gps:2", "--json", "--out", tmp_path / "a"
    )
    assert done.returncode == 0, done.stderr
    fed_back = main("run", "--config", tmp_path / "a" / "study.toml", "--json", "--out", tmp_path / "c")
    assert fed_back.stdout == done.stdout
    assert (tmp_path / "c" / "study.nc").read_bytes() == (tmp_path / "a" / "study.nc").read_bytes()
    fresh = main("run", "--estimator", "gps", "--trial", 2, "--duration", 14, "--json", "--out", tmp_path / "b")
    assert done.stdout == fresh.stdout
    row = json.loads(done.stdout)
    assert (row["plant"], row["estimator"], row["trials"]) == ("rigid", "gps", 1)
    assert len(row["final_position_m"]) == 3
    assert (tmp_path / "a" / "trajectories.png").is_file()


def test_runs_take_another_ground_load_and_laws(main, tmp_path):
    options = ["--estimator", "gps", "--duration", 3, "--friction", "0.3..0.9", "--slope", 0.05, "--payload", 2]
    options += ["--steering", "heading", "--sensing", "truth", "--gains", "first", "--seed", 4, "--trial", 5]
    one, again = (main("run", *options, "--json", "--out", tmp_path / name) for name in "ab")
    assert one.returncode == 0, one.stderr
    assert one.stdout == again.stdout
    table = tomllib.loads((tmp_path / "a" / "study.toml").read_text())["vehicle"]
    assert table == {
        "model": "dynabot", "friction": [0.3, 0.9], "slope": 0.05, "payload": 2.0, "steering": "heading",
        "sensing": "truth", "gains": "first",
    }  # fmt: skip
    # The trial's own friction alone differs in another trial's draw from the same range.
    options[options.index("0.3..0.9")] = "0.3..0.31"
    assert main("run", *options, "--json", "--out", tmp_path / "c").stdout != one.stdout


def test_a_trial_is_reproduced_only_with_the_gains_of_its_study(main, tmp_path):
    gain_file = tmp_path / "mine.toml"
    text = gains.path("first").read_text(encoding="utf-8")
    gain_file.write_text(text, encoding="utf-8")
    options = ["--estimator", "gps", "--duration", 2, "--gains", gain_file]
    first = main("run", *options, "--json", "--out", tmp_path / "a")
    assert first.returncode == 0, first.stderr
    reproduce = ["run", "--reproduce", f"{tmp_path / 'a'}:rigid/gauss-markov/gps:0", "--json", "--out", tmp_path / "b"]
    assert main(*reproduce).stdout == first.stdout
    gain_file.write_text(text.replace("hold = 1.5", "hold = 1.6"), encoding="utf-8")
    done = main(*reproduce)
    assert done.returncode == 2
    assert done.stderr.startswith(
        f"dynabot: the gains '{gain_file}' of {tmp_path / 'a' / 'study.nc'} has changed since"
    )
    assert len(done.stderr.splitlines()) == 1
    gain_file.unlink()
    done = main(*reproduce)
    assert done.returncode == 2
    assert "it must be a gain file or one of" in done.stderr


def test_a_study_of_other_versions_is_repeated_with_a_warning(main, dataset, tmp_path):
    study.save(dataset.assign_attrs(versions="dynabot-mj 0.0.1"), tmp_path / "study.nc")
    done = main("run", "--reproduce", f"{tmp_path}:particle/gauss-markov/gps:0", "--out", tmp_path / "a")
    assert done.returncode == 0
    assert done.stderr.startswith("dynabot: that study was run by dynabot-mj 0.0.1, this is dynabot-mj ")
    study.save(dataset, tmp_path / "study.nc")
    done = main("run", "--reproduce", f"{tmp_path}:particle/gauss-markov/gps:0", "--out", tmp_path / "a")
    assert "that study" not in done.stderr


def test_a_trial_with_a_law_of_the_user_is_reproduced_from_another_folder(main, dynabot, tmp_path):
    home, elsewhere = tmp_path / "home", tmp_path / "elsewhere"
    home.mkdir()
    elsewhere.mkdir()
    (home / "resting_law.py").write_text("def law(known):\n    return 0.0 * known.position_w\n", encoding="utf-8")
    options = [
        "--plant",
        "particle",
        "--estimator",
        "gps",
        "--duration",
        2,
        "--controller",
        "resting_law:law",
        "--json",
    ]
    first = main("run", *options, cwd=home)
    assert first.returncode == 0, first.stderr
    case = f"{home / 'out' / 'run'}:particle/gauss-markov/gps:0"
    assert dynabot("run", "--reproduce", case, "--json", cwd=elsewhere).stdout == first.stdout
    (home / "resting_law.py").write_text("def law(known):\n    return 1.0 + 0.0 * known.position_w\n", encoding="utf-8")
    changed = main("run", "--reproduce", case, cwd=elsewhere)
    assert changed.returncode == 2
    assert "has changed since that study" in changed.stderr
