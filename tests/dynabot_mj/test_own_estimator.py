"""The estimator of docs/own-estimator.md is the very text of the document, and its commands run."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

DOCUMENT = Path(__file__).parents[2] / "docs" / "own-estimator.md"
BLOCK = re.compile(r"```(\w+)\n(.*?)```", re.DOTALL)


@pytest.fixture(scope="module")
def blocks():
    """The document's code, by language."""
    found = BLOCK.findall(DOCUMENT.read_text(encoding="utf-8"))
    assert [language for language, _ in found] == ["python", "toml", "sh"]
    return dict(found)


@pytest.fixture(scope="module")
def folder(blocks, tmp_path_factory):
    """A folder with the two files that the document says to save."""
    made = tmp_path_factory.mktemp("own")
    (made / "constant_gain.py").write_text(blocks["python"])
    (made / "mine.toml").write_text(blocks["toml"])
    return made


def command(blocks, start):
    """Returns the arguments of one of the document's commands."""
    (line,) = (one for one in blocks["sh"].splitlines() if one.startswith(f"dynabot {start}"))
    return line.split()[1:]


@pytest.fixture(scope="module")
def study(blocks, folder, dynabot):
    """Runs the document's comparison, shorter, on two workers."""
    short = ["--plants", "particle", "rigid", "--trials", "4", "--duration", "4", "--workers", "2"]
    done = dynabot(*command(blocks, "compare"), *short, "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_it_stands_beside_the_papers_in_a_comparison_of_both_plants(study, folder):
    rows = {(row["plant"], row["perception"], row["estimator"]): row for row in study["rows"]}
    assert len(rows) == 8
    for (_, perception, name), row in rows.items():
        assert (row["paper"] is None) == (name == "mine")
        assert row["diverged"] == 0
        if name == "mine" and perception == "filter":
            # The same robots, samples and starts: in 4 s both errors are mostly those of the first fix.
            other = rows[row["plant"], "filter", "decoupled"]
            errors = [one["estimate_error"]["position_rms_m"] for one in (row, other)]
            assert 0.5 < errors[0] / errors[1] < 2.0
    table = (folder / "out" / "compare" / "table.md").read_text()
    assert re.search(r"^\| mine +\|", table, re.MULTILINE)


def test_a_saved_trial_is_repeated_only_with_the_same_filter(study, folder, dynabot):
    again = ["run", "--reproduce", "out/compare/study.nc:rigid/filter/mine:1", "--json"]
    done = dynabot(*again, cwd=folder)
    assert done.returncode == 0, done.stderr
    module = folder / "constant_gain.py"
    text = module.read_text()
    try:
        module.write_text(text.replace("0.25", "0.24"))
        changed = dynabot(*again, cwd=folder)
    finally:
        module.write_text(text)
    assert changed.returncode == 2
    assert "constant_gain:ConstantGain" in changed.stderr


def test_the_circle_finds_what_the_document_says(blocks, folder, dynabot):
    """Its accuracy is that of the decoupled EKF or worse, and the document gives it as its uncertainty."""
    done = dynabot(*command(blocks, "circle"), "--runs", "2", "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    rows = {row["estimator"]: row for row in json.loads(done.stdout)["rows"]}
    assert list(rows) == ["gps", "decoupled", "coupled", "mine"]
    assert rows["mine"]["paper_m"] is None
    # By the same path and samples; two runs cannot tell how much worse, but not twice as bad (docs: 1.2 of 1.1 m).
    assert 0.5 < rows["mine"]["uncertainty_m"]["mean"] / rows["decoupled"]["uncertainty_m"]["mean"] < 2.0


def test_a_mistake_in_it_is_one_line(folder, dynabot):
    text = (folder / "constant_gain.py").read_text()
    (folder / "mistaken.py").write_text(text.replace('"heading": self.heading,', '"heading": self.heading[:, None],'))
    toml = (folder / "mine.toml").read_text().replace("constant_gain:", "mistaken:")
    (folder / "mistaken.toml").write_text(toml)
    options = ["--trials", "1", "--duration", "2", "--workers", "1", "--out", "bad"]
    done = dynabot(
        *("compare", "--config", "mistaken.toml", "--estimators", "mine", "--perception", "filter", *options),
        cwd=folder,
    )
    assert done.returncode == 2
    assert "method mine: ConstantGain.beliefs returned heading of shape (3, 1), it must be (3,)" in done.stderr
    assert not [file for file in (folder / "bad").iterdir() if not file.name.startswith(".")]


DASK = """
import sys
from distributed import Client, LocalCluster
from dynabot_mj import study
from dynabot_mj.study import configuration
from dynabot_mj.study.execution import Execution

if __name__ == "__main__":
    setup = configuration.load_file(
        "mine.toml", {}, estimators=["mine"], perception=["filter"], plants=["particle"], trials=3, duration=4.0
    )
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with Client(cluster):
            study.save(study.run(setup, Execution(scheduler=cluster.scheduler_address)), sys.argv[1])
    study.save(study.run(setup, Execution(workers=1)), sys.argv[2])
"""


def test_a_cluster_gives_the_same_bytes(folder):
    pytest.importorskip("distributed")
    (folder / "on_dask.py").write_text(DASK)
    subprocess.run(
        [sys.executable, "on_dask.py", "a.nc", "b.nc"], cwd=folder, check=True, capture_output=True, timeout=300
    )
    assert (folder / "a.nc").read_bytes() == (folder / "b.nc").read_bytes()


@pytest.mark.slow
def test_the_documents_other_commands_run(blocks, folder, dynabot):
    (folder / "short.toml").write_text(f"duration = 3.0\n{(folder / 'mine.toml').read_text()}")
    for start, options in (("video", ["--size", "480x270", "--rate", "5"]), ("benchmark filters", [])):
        line = command(blocks, start)
        if start == "video":
            line = [part.replace("mine.toml", "short.toml") for part in line]
        done = dynabot(*line, *options, cwd=folder)
        assert done.returncode == 0, done.stderr
