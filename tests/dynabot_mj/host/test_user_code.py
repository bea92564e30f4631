import sys

import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.host import user_code


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "code_of_a_user.py").write_text("print('hello')\nnumber = 3\n\n\ndef law():\n    pass\n")
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.delitem(sys.modules, "code_of_a_user", raising=False)
    return tmp_path


def load(name):
    return user_code.load(f"law {name!r}", name, "my_module:my_law")


def test_a_module_of_the_working_directory_is_found_and_prints_elsewhere(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    assert load("code_of_a_user:law").__name__ == "law"
    assert capsys.readouterr() == ("", "hello\n")


def test_another_folder_can_be_looked_in(folder, monkeypatch, tmp_path_factory):
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))
    with pytest.raises(InputError, match="No module named"):
        load("code_of_a_user:law")
    user_code.look_in(folder)
    user_code.look_in(None)
    assert user_code.source(load("code_of_a_user:law")) == folder / "code_of_a_user.py"


def test_what_is_of_no_module_has_no_file():
    assert user_code.source(load("random:random")) is None


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("code_of_a_user", "law 'code_of_a_user' given, it must be my_module:my_law"),
        (":law", "it must be my_module:my_law"),
        ("code_of_a_user:low", "has no attribute 'low'"),
        ("code_of_a_user:number", "it must be a function"),
        ("no_module_of_a_user:law", "cannot be imported: ModuleNotFoundError"),
    ],
)
def test_what_cannot_be_had_is_told(folder, monkeypatch, name, told):
    monkeypatch.chdir(folder)
    with pytest.raises(InputError, match=told):
        load(name)


def test_what_fails_is_told_in_one_line_with_where(capsys):
    def fail():
        print("to stderr")
        raise ValueError("two\nlines")

    told = r"^law failed: ValueError: two lines \(test_user_code\.py, line \d+\)$"
    with pytest.raises(InputError, match=told), user_code.called("law failed"):
        fail()
    assert capsys.readouterr() == ("", "to stderr\n")
