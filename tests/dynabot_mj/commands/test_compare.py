import json


def test_compare_writes_results_that_can_be_fed_back_in(dynabot, tmp_path):
    first = dynabot(
        "compare",
        "--trials",
        2,
        "--duration",
        14,
        "--seed",
        3,
        "--estimators",
        "perfect",
        "gps",
        "--json",
        "--out",
        tmp_path / "a",
    )
    assert first.returncode == 0, first.stderr
    document = json.loads(first.stdout)
    assert len(document["rows"]) == 4
    assert document["wall_s"] > 0
    names = {file.name for file in (tmp_path / "a").iterdir() if not file.name.startswith(".")}
    assert names == {
        "study.nc", "study.toml", "execution.json", "table.md", "compare.json", "table_iii.png", "errors.png",
        "outcomes.png", "incidence.png",
        "trajectories_perfect.png", "trajectories_gps.png",
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


def test_compare_prints_its_tables_and_where_they_are(dynabot, tmp_path):
    told = dynabot("compare", "--trials", 1, "--duration", 14, "--plants", "particle", "--out", tmp_path)
    assert "| decoupled" in told.stdout
    assert str(tmp_path) in told.stdout
    assert "not arrived within 14 s: 100 % of particle/perfect" in told.stderr


def test_a_finished_study_is_kept_or_printed_again_never_lost(dynabot, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    line = ["compare", "--trials", 1, "--duration", 14, "--plants", "particle", "--estimators", "gps", "--json"]
    first = dynabot(*line, cwd=tmp_path)
    assert first.returncode == 0, first.stderr
    place = tmp_path / "out" / "compare"
    before = {file.name: (file.stat().st_mtime_ns, file.read_bytes()) for file in place.iterdir()}

    def unchanged():
        return before == {file.name: (file.stat().st_mtime_ns, file.read_bytes()) for file in place.iterdir()}

    again = dynabot(*line, "--resume", cwd=tmp_path)
    assert (again.returncode, again.stdout) == (0, first.stdout)
    assert unchanged()
    refused = {
        (
            "--resume",
            "--seed",
            3,
        ): "--resume given, but out/compare holds another compare (seed 0 there and 3 here)",
        ("--out", place, "--seed", 3): f"{place} holds another compare (seed 0 there and 3 here); --overwrite replaces",
    }
    for options, told in refused.items():
        done = dynabot(*line, *options, cwd=tmp_path)
        assert done.returncode == 2
        assert done.stderr.startswith(f"dynabot: {told}")
        assert done.stderr.count("\n") == 1
    run = dynabot("run", "--duration", 14, "--out", place, cwd=tmp_path)
    assert run.returncode == 2
    assert unchanged()
    # A missing figure is drawn again from what was computed.
    (place / "outcomes.png").unlink()
    dynabot(*line, "--resume", cwd=tmp_path)
    assert (place / "outcomes.png").is_file()
    assert (place / "study.nc").read_bytes() == before["study.nc"][1]
    replaced = dynabot(*line, "--seed", 3, cwd=tmp_path)
    assert replaced.returncode == 0
    assert "note: out/compare holds another compare (seed 0 there and 3 here); it will be replaced" in replaced.stderr


def test_sensitivity_is_a_study_of_its_own_and_leaves_no_parts(dynabot, tmp_path):
    line = ["compare", "--sensitivity", "--trials", 1, "--duration", 1, "--estimators", "gps", "--workers", 1, "--json"]
    done = dynabot(*line, "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert len(json.loads(done.stdout)["readings"]) > 15
    assert {file.name for file in tmp_path.iterdir()} == {
        ".results", "study.toml", "sensitivity.json", "sensitivity.md", "sensitivity.png",
    }  # fmt: skip
    refused = dynabot("compare", "--sensitivity", "--plants", "rigid", "--out", tmp_path)
    assert refused.returncode == 2
    assert refused.stderr.startswith("dynabot: plants = rigid given with --sensitivity")
