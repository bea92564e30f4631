import json
import tomllib

from dynabot_mj import study


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
