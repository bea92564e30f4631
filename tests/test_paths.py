"""Every path that the documents name is there, every module named in the layout, and a test of every module."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
# Paths below these folders; results, and what users are told to make, are not ours.
PATH = re.compile(r"(?<![\w/.])((?:docs|dynabot_mj|models|controllers|estimation|tests)/[\w/.-]*\w)")
# Modules without tests of their own: they state types, constants and fields, and nothing that could be wrong by itself.
UNTESTED = {
    "controllers/arrays",
    "controllers/law",
    "dynabot_mj/__main__",
    "dynabot_mj/formation/leader",
    "dynabot_mj/formation/options",
    "dynabot_mj/plants/options",
    "dynabot_mj/plants/plant",
    "dynabot_mj/testbed/options",
    "estimation/arrays",
    "estimation/parameters",
}
MODULE = re.compile(r"`(dynabot_mj(?:\.\w+)+)`?")


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_paths_in_documents_exist(document):
    text = document.read_text(encoding="utf-8")
    named = set(PATH.findall(text))
    missing = [name for name in named if not any((ROOT / f"{name}{suffix}").exists() for suffix in ("", ".py"))]
    assert not [name for name in missing if not (ROOT / "dynabot_mj" / name).exists()], missing


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_modules_in_documents_exist(document):
    for name in set(MODULE.findall(document.read_text(encoding="utf-8"))):
        parts = name.split(".")
        # A module, or a name in one.
        places = [ROOT.joinpath(*parts[:end]) for end in (len(parts), len(parts) - 1)]
        assert any(place.is_dir() or place.with_suffix(".py").is_file() for place in places), name


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_imports_in_documents_work(document):
    for line in re.findall(r"^from dynabot_mj[\w.]* import .*$", document.read_text(encoding="utf-8"), flags=re.M):
        exec(line, {})


def test_every_room_of_the_layout_is_there():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    layout = text[text.index("## Layout") :]
    rooms = set(re.findall(r"^  ([a-z]+)/|(?<= )([a-z]+)/(?= )", layout[: layout.index("tests/ ")], flags=re.M))
    named = {one or other for one, other in rooms}
    folders = {path.name for path in (ROOT / "dynabot_mj").iterdir() if (path / "__init__.py").is_file()}
    assert folders - {"models", "controllers", "estimation"} <= named | {"formation", "estimators", "vehicle"}, named


def test_every_module_has_a_test_file_of_its_name_or_nothing_to_test():
    # The leaves where they are, not where they are linked: links are not followed.
    modules = [
        file.relative_to(ROOT).with_suffix("")
        for folder in ("controllers", "dynabot_mj", "estimation", "models")
        for file in (ROOT / folder).rglob("*.py")
        if file.stem != "__init__"
    ]
    assert len(modules) > 100  # it did look
    tests = ROOT / "tests"
    without = {one.as_posix() for one in modules if not (tests / one.parent / f"test_{one.name}.py").is_file()}
    assert without == UNTESTED
