import argparse
import json

import pytest

from dynabot_mj.commands import benchmark
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.environment import benchmark as benchmark_environment
from dynabot_mj.experiments.estimators import benchmark as benchmark_filters
from dynabot_mj.film import benchmark as benchmark_video
from dynabot_mj.film.shot import OVERLAYS
from dynabot_mj.host.opengl import GraphicsError


def run(*arguments):
    parser = argparse.ArgumentParser()
    benchmark.add(parser.add_subparsers())
    options = parser.parse_args(["benchmark", *arguments])
    options.function(options)


def test_benchmark_prints_one_json_document_and_writes_its_results(tmp_path, capsys):
    run("filters", "--robots", "2", "--repetitions", "1", "--json", "--out", str(tmp_path / "a"))
    document = json.loads(capsys.readouterr().out)
    assert document["filters"]["robots"] == 2
    assert json.loads((tmp_path / "a" / "benchmark.json").read_text()) == document
    assert "| decoupled" in (tmp_path / "a" / "benchmark.md").read_text()


def test_the_environment_has_sizes_of_its_own(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(benchmark_environment, "_DURATION", 0.2)
    run("environment", "--repetitions", "1", "--json", "--out", str(tmp_path / "a"))
    document = json.loads(capsys.readouterr().out)["environment"]
    assert (document["robots"], document["repetitions"]) == (3, 1)


@pytest.mark.usefixtures("small_loop")
def test_the_loop_and_the_radio_are_subjects(tmp_path, capsys):
    run("loop", "--robots", "2", "--repetitions", "1", "--json", "--out", str(tmp_path / "a"))
    loop = json.loads(capsys.readouterr().out)
    assert (loop["loop"]["robots"], loop["loop"]["repetitions"]) == (2, 1)
    assert loop["loop"]["overhead_ratio"] > 0.0
    assert "mujoco" in loop["made"]["versions"]
    run("radio", "--repetitions", "1", "--json", "--out", str(tmp_path / "b"))
    assert len(json.loads(capsys.readouterr().out)["radio"]["rows"]) == 6


@pytest.mark.usefixtures("small_loop")
@pytest.mark.parametrize("json_asked", [True, False])
def test_all_subjects_are_measured_by_default_and_films_are_skipped_where_there_are_no_graphics(
    json_asked, tmp_path, capsys, monkeypatch
):
    def none(*_):
        raise GraphicsError("nothing draws here")

    monkeypatch.setattr(benchmark_environment, "_DURATION", 0.2)
    monkeypatch.setattr(benchmark_video, "run", none)
    monkeypatch.setattr(benchmark_filters, "_STEPS", 1)
    run(*(["--json"] if json_asked else []), "--out", str(tmp_path / "a"))
    out = capsys.readouterr().out
    document = json.loads((tmp_path / "a" / "benchmark.json").read_text())
    assert list(document) == ["loop", "filters", "radio", "environment", "video", "made"]
    assert document["video"] == {"skipped": "nothing draws here"}
    assert document["environment"]["repetitions"] == 2
    if json_asked:
        assert json.loads(out) == document
    else:
        assert out.count("# Cost of ") == 4
        assert "Skipped: nothing draws here" in out
        assert f"Made {document['made']['date']}, " in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--robots", "3"], "--robots given without a subject"),
        (["--repetitions", "3"], "--repetitions given without a subject"),
        (["radio", "--robots", "3"], "--robots given with radio"),
        (["loop", "--config", "mine.toml"], "--config given with loop"),
    ],
)
def test_options_that_do_nothing_are_refused(arguments, message, tmp_path):
    with pytest.raises(InputError, match=message):
        run(*arguments, "--out", str(tmp_path / "a"))
    assert not (tmp_path / "a").exists()


@pytest.mark.parametrize("option", ["--robots", "--repetitions"])
def test_there_must_be_something_to_measure(option, tmp_path):
    with pytest.raises(InputError, match=f"{option} 0 given, it must be at least 1"):
        run("filters", option, "0", "--out", str(tmp_path / "a"))
    assert not (tmp_path / "a").exists()


@pytest.mark.usefixtures("graphics")
def test_a_film_is_drawn_in_two_sizes_with_and_without_each_overlay(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(benchmark_video, "_DURATION", 1.0)
    monkeypatch.setattr(benchmark_video, "_ENCODED", 6)
    run("video", "--repetitions", "2", "--json", "--out", str(tmp_path / "a"))
    rows = json.loads(capsys.readouterr().out)["video"]["rows"]
    assert [(row["width"], row["height"]) for row in rows] == [(1280, 720), (640, 480)]
    for row in rows:
        assert min(row["frames_per_second"], row["bare_per_second"], row["encoded_per_second"]) > 0.0
        assert set(row["overlays_ms"]) == set(OVERLAYS)
