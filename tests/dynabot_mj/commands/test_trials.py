from dynabot_mj import study
from dynabot_mj.controllers import gains


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
