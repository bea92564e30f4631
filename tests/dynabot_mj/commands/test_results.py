import argparse
import json

import pytest

from dynabot_mj.commands import results
from dynabot_mj.common.exceptions import InputError

NAMES = ("paint.json", "paint.md", "paint.png")


def options(out=None, overwrite=False, json=False, **others):
    return argparse.Namespace(out=out, overwrite=overwrite, json=json, **others)


def paint(asked, colour="red"):
    """Leaves a document, a text and a picture behind."""
    with (
        results.opened(asked, "paint", {"colour": colour}, NAMES) as folder,
        results.report(asked, folder, "paint", {"colour": colour}, f"It is {colour}.\n", "; look at it") as stage,
    ):
        (stage / "paint.png").write_bytes(colour.encode())


def test_document_text_and_what_else_is_made_are_kept_and_one_of_them_is_printed(tmp_path, capsys):
    paint(options(tmp_path / "a"))
    assert capsys.readouterr().out == f"It is red.\n\nresults in {tmp_path / 'a'}; look at it\n"
    paint(options(tmp_path / "a", json=True))
    assert json.loads(capsys.readouterr().out) == {"colour": "red"}
    assert json.loads((tmp_path / "a" / "paint.json").read_text()) == {"colour": "red"}
    assert (tmp_path / "a" / "paint.md").read_text() == "It is red.\n"
    assert {file.name for file in (tmp_path / "a").iterdir()} == {*NAMES, ".results"}


def test_other_results_are_kept_where_a_folder_was_chosen_and_replaced_where_none_was(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    paint(options())
    paint(options(), colour="blue")
    told = "note: out/paint holds another paint (colour red there and blue here); it will be replaced\n"
    assert capsys.readouterr().err == told
    here = tmp_path / "out" / "paint"
    with pytest.raises(InputError, match="--overwrite replaces it"):
        paint(options(here))
    assert (here / "paint.png").read_bytes() == b"blue"
    paint(options(here, overwrite=True))
    assert (here / "paint.png").read_bytes() == b"red"


def test_there_must_be_something_to_overwrite_or_to_resume(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match="--overwrite given without --out: out/paint is replaced without it"):
        paint(options(overwrite=True))
    paint(options())
    with pytest.raises(InputError, match=r"--resume given, but out/paint holds another paint .* run without --resume"):
        paint(options(resume=True), colour="blue")


def test_a_document_has_no_undefined_numbers():
    with pytest.raises(ValueError, match="JSON"):
        results.dump({"mean": float("nan")})
