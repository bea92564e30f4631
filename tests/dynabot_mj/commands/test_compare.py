import json

from dynabot_mj.experiments.formation import sensitivity


def test_compare_writes_results_that_can_be_fed_back_in(dynabot, main, tmp_path):
    first = dynabot(
        "compare",
        "--trials",
        2,
        "--duration",
        14,
        "--seed",
        3,
        "--estimators",
        "gps",
        "--json",
        "--out",
        tmp_path / "a",
    )
    assert first.returncode == 0, first.stderr
    document = json.loads(first.stdout)
    assert len(document["rows"]) == 2
    assert document["wall_s"] > 0
    names = {file.name for file in (tmp_path / "a").iterdir() if not file.name.startswith(".")}
    assert names == {
        "study.nc", "study.toml", "execution.json", "table.md", "compare.json", "table_iii.png", "errors.png",
        "outcomes.png", "incidence.png", "trajectories_gps.png",
    }  # fmt: skip
    again = main(
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


def test_compare_prints_its_tables_and_where_they_are(main, tmp_path):
    options = ["--trials", 1, "--duration", 14, "--plants", "particle", "--estimators", "perfect", "decoupled"]
    told = main("compare", *options, "--out", tmp_path)
    assert "| decoupled" in told.stdout
    assert str(tmp_path) in told.stdout
    assert {file.name for file in tmp_path.glob("traj*")} == {f"trajectories_{name}.png" for name in options[-2:]}
    assert "not arrived within 14 s: 100 % of particle/perfect" in told.stderr


def test_a_finished_study_is_kept_or_printed_again_never_lost(main, tmp_path):
    line = ["compare", "--trials", 1, "--duration", 14, "--plants", "particle", "--estimators", "gps", "--json"]
    first = main(*line, cwd=tmp_path)
    assert first.returncode == 0, first.stderr
    place = tmp_path / "out" / "compare"
    before = {file.name: (file.stat().st_mtime_ns, file.read_bytes()) for file in place.iterdir()}

    def unchanged():
        return before == {file.name: (file.stat().st_mtime_ns, file.read_bytes()) for file in place.iterdir()}

    again = main(*line, "--resume", cwd=tmp_path)
    assert (again.returncode, again.stdout) == (0, first.stdout)
    assert unchanged()
    refused = {
        ("--resume", "--seed", 3): "--resume given, but out/compare holds another compare (seed 0 there and 3 here)",
        ("--out", place, "--seed", 3): f"{place} holds another compare (seed 0 there and 3 here); --overwrite replaces",
    }
    for options, told in refused.items():
        done = main(*line, *options, cwd=tmp_path)
        assert done.returncode == 2
        assert done.stderr.startswith(f"dynabot: {told}")
        assert done.stderr.count("\n") == 1
    run = main("run", "--duration", 14, "--out", place, cwd=tmp_path)
    assert run.returncode == 2
    assert unchanged()
    # A missing figure is drawn again from what was computed.
    (place / "outcomes.png").unlink()
    main(*line, "--resume", cwd=tmp_path)
    assert (place / "outcomes.png").is_file()
    assert (place / "study.nc").read_bytes() == before["study.nc"][1]
    replaced = main(*line, "--seed", 3, cwd=tmp_path)
    assert replaced.returncode == 0
    assert "note: out/compare holds another compare (seed 0 there and 3 here); it will be replaced" in replaced.stderr


def test_sensitivity_is_a_study_of_its_own_and_leaves_no_parts(main, tmp_path, monkeypatch):
    readings = sensitivity.readings
    monkeypatch.setattr(sensitivity, "readings", lambda setup: readings(setup)[:3])  # without the long runs
    line = ["compare", "--sensitivity", "--trials", 1, "--duration", 1, "--estimators", "gps", "--workers", 1, "--json"]
    done = main(*line, "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert [one["reading"] for one in json.loads(done.stdout)["readings"]] == ["as it is", "tau 0.04 s", "tau 0.16 s"]
    assert {file.name for file in tmp_path.iterdir()} == {
        ".results", "study.toml", "sensitivity.json", "sensitivity.md", "sensitivity.png",
    }  # fmt: skip
    refused = main("compare", "--sensitivity", "--plants", "rigid", "--out", tmp_path)
    assert refused.returncode == 2
    assert refused.stderr.startswith("dynabot: plants = rigid given with --sensitivity")
