"""What the package offers to those who import it."""

import ast
import dataclasses
import doctest
import importlib
import inspect
import pkgutil
import re
from pathlib import Path

import numpy as np
import pytest

import dynabot_mj as dy

ROOT = Path(__file__).parents[2]


def told(name):
    """Returns the docstrings of a public name, and what it takes."""
    thing = getattr(dy, name)
    texts, taken = [inspect.getdoc(thing) or ""], []
    if dataclasses.is_dataclass(thing):
        taken = [field.name for field in dataclasses.fields(thing)]
    elif not inspect.isclass(thing):
        taken = list(inspect.signature(thing).parameters)
    elif "__init__" in vars(thing) and not getattr(thing, "_is_protocol", False):
        texts.append(inspect.getdoc(thing.__init__))
        taken = list(inspect.signature(thing).parameters)
    return "\n".join(texts), taken


@pytest.mark.parametrize("name", dy.__all__)
def test_a_public_name_says_what_it_takes(name):
    text, taken = told(name)
    section = re.search(r"^(?:Args|Attributes):\n((?:    .*\n?|\n)+)", text, flags=re.M)
    said = re.findall(r"^    \*{0,2}(\w+): \S", section[1], flags=re.M) if section else []
    assert said == taken


@pytest.mark.parametrize("name", dy.__all__)
def test_the_example_of_a_public_name_runs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (found,) = doctest.DocTestFinder(recurse=False).find(
        getattr(dy, name), name, module=False, globs={"dy": dy, "np": np}
    )
    lines = []
    result = doctest.DocTestRunner().run(found, out=lines.append)
    assert "Example:" in found.docstring
    assert result.attempted > 0
    assert not result.failed, "".join(lines)


def test_the_example_of_the_package_runs():
    assert doctest.testmod(dy, extraglobs={"dy": dy}).failed == 0


def test_type_checkers_see_what_is_imported():
    (typed,) = (
        node for node in ast.parse(Path(dy.__file__).read_text(encoding="utf-8")).body if isinstance(node, ast.If)
    )
    seen = {
        one.asname or one.name: f"{node.module.removeprefix('dynabot_mj.')}:{one.name}"
        for node in typed.body
        for one in node.names
    }
    assert seen == dy._HOMES
    assert sorted(seen) == sorted(dy.__all__)
    assert Path(dy.__file__).with_name("py.typed").is_file()


def test_no_public_name_hides_a_room():
    rooms = {module.name for module in pkgutil.iter_modules(dy.__path__)}
    assert not rooms & set(dy.__all__)
    assert all(importlib.import_module(f"dynabot_mj.{room}") is getattr(dy, room) for room in ("study", "environment"))


def test_public_names_are_listed_and_others_are_refused():
    assert set(dy.__all__) <= set(dir(dy))
    assert dy.run is importlib.import_module("dynabot_mj.study").run
    with pytest.raises(AttributeError, match="module 'dynabot_mj' has no attribute 'bogus'"):
        _ = dy.bogus


def test_the_docstring_names_all_that_is_public():
    groups = dy.__doc__[dy.__doc__.index("    scenarios") : dy.__doc__.index("Shapes:")]
    assert set(re.findall(r"\w+", groups)) >= set(dy.__all__)


def test_the_readmes_example_runs(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", text[text.index("## From Python") :], flags=re.S)
    assert code.count("\n") <= 15
    exec(code, {})
    assert "arrival" in capsys.readouterr().out
    assert [path.name for path in tmp_path.iterdir()] == ["study.nc"]
