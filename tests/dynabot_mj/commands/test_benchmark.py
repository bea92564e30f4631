import argparse
import json

import pytest

from dynabot_mj.commands import benchmark
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.environment import benchmark as benchmark_environment
from dynabot_mj.film import benchmark as benchmark_video
from dynabot_mj.film.shot import OVERLAYS


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
