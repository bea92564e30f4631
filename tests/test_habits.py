"""What a public repository says of itself in several files is the same in all of them."""

import re
import tomllib
from pathlib import Path

import pytest

import dynabot_mj

ROOT = Path(__file__).parents[1]
yaml = pytest.importorskip("yaml")  # dask brings it


@pytest.fixture(scope="module")
def project():
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def read():
    return lambda name: yaml.safe_load((ROOT / name).read_text(encoding="utf-8"))


def test_the_version_is_the_same_everywhere(project, read):
    assert project["project"]["dynamic"] == ["version"]
    assert project["tool"]["setuptools"]["dynamic"]["version"]["attr"] == "dynabot_mj.__version__"
    assert str(read("CITATION.cff")["version"]) == dynabot_mj.__version__
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.findall(r"^## (.+)$", changes, flags=re.M)[:2] == ["Unreleased", dynabot_mj.__version__]


def test_the_citation_is_of_this_package(project, read):
    citation = read("CITATION.cff")
    assert (citation["title"], citation["license"]) == (project["project"]["name"], project["project"]["license"])
    assert citation["abstract"] == project["project"]["description"]


def test_the_pythons_that_are_tested_are_those_that_the_package_is_for(project, read):
    matrix = read(".github/workflows/test.yml")["jobs"]["test"]["strategy"]["matrix"]
    prefix = "Programming Language :: Python :: 3."
    named = [name.rpartition(" ")[2] for name in project["project"]["classifiers"] if name.startswith(prefix)]
    assert matrix["python"] == named
    assert project["project"]["requires-python"] == f">={named[0]}"


def test_hooks_are_the_checks_of_make_test(read):
    hooks = [hook["entry"] for repository in read(".pre-commit-config.yaml")["repos"] for hook in repository["hooks"]]
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8").replace("$(BIN)", ".venv/bin")
    recipe = re.search(r"^test: .*\n((?:\t.*\n)+)", makefile, flags=re.M).group(1)
    assert hooks == [line.strip() for line in recipe.splitlines() if "pytest" not in line]


def test_the_peers_are_run_by_commands_that_are_there_and_stay_out_of_the_package(project):
    text = (ROOT / "benchmarks" / "peers" / "README.md").read_text(encoding="utf-8")
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8").replace("$(PEERS)", "benchmarks/peers")
    named = set(re.findall(r"benchmarks/peers/(?!\.venv)[\w.]*\w", text + makefile))
    assert named >= {f"benchmarks/peers/{name}" for name in ("bodies.py", "particles.py", "requirements.txt")}
    assert not [name for name in named if not (ROOT / name).is_file()]
    for target in re.findall(r"make (\w+)", text):
        assert re.search(rf"^{target}:", makefile, flags=re.M), target
    assert "benchmarks/peers/.venv" in text
    assert ".venv/" in (ROOT / ".gitignore").read_text(encoding="utf-8").splitlines()  # wherever it is
    # It brings libraries that the package must not need.
    assert project["tool"]["setuptools"]["packages"]["find"]["include"] == ["dynabot_mj*"]
    peers = {file.stem for file in (ROOT / "benchmarks").rglob("*.py") if ".venv" not in file.parts}
    assert len(peers) == 4
    required = {re.split(r"[=<>]", line)[0] for line in (ROOT / "requirements.lock").read_text().splitlines()}
    assert not required & {"torch", "vmas"}
    for file in (ROOT / "dynabot_mj").rglob("*.py"):
        assert not re.search(
            r"^\s*(import|from) (torch|vmas|benchmarks)\b", file.read_text(encoding="utf-8"), flags=re.M
        )


def test_what_the_contributing_names_beside_packages_is_there():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    named = set(
        re.findall(r"(?<![\w/.])(\.(?:ci|github)/[\w/.]*\w|\.pre-commit-config\.yaml|[A-Z]+\.md|[\w]+\.lock)", text)
    )
    assert named >= {
        ".ci/run",
        ".github/workflows/test.yml",
        ".pre-commit-config.yaml",
        "requirements.lock",
        "README.md",
    }
    assert not [name for name in named if not (ROOT / name).exists()]


def test_the_baseline_of_the_performance_is_what_the_command_prints():
    text = (ROOT / "docs" / "performance.md").read_text(encoding="utf-8")
    headline = re.search(r"^overhead_ratio ([\d.]+): ", text, flags=re.M).group(1)
    row = re.search(r"^\| gauss-markov \| 100 +\| 1 +\|.*$", text, flags=re.M).group(0)
    assert row.split("|")[6].strip() == headline
    assert re.search(r"^Made \d{4}-\d\d-\d\d, \d+ cores; dynabot-mj ", text, flags=re.M)
