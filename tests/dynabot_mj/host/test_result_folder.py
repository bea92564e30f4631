import json
import os
import subprocess
import sys

import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.host import result_folder
from dynabot_mj.host.result_folder import Contents

NAMES = ("a.txt", "b.txt", "part_*.png")


def contents(command="study", **options):
    return Contents(command=command, options=options, files=NAMES)


def write(folder, kind=None, *, keep=True, **files):
    with result_folder.opened(folder, kind or contents(seed=0), keep=keep) as opened, opened.drafted() as draft:
        for name, text in files.items():
            (draft / name.replace("_txt", ".txt")).write_text(text)


def visible(folder):
    return {file.name: file.read_text() for file in folder.iterdir() if not file.name.startswith(".")}


def test_results_appear_only_when_all_are_complete(tmp_path):
    write(tmp_path, a_txt="old")

    def interrupted():
        with result_folder.opened(tmp_path, contents(seed=0), keep=True) as opened, opened.drafted() as draft:
            (draft / "a.txt").write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert visible(tmp_path) == {"a.txt": "old"}
    assert [file.name for file in tmp_path.iterdir() if file.name.startswith(".")] == [".results"]
    (tmp_path / "mine.txt").write_text("keep")
    write(tmp_path, a_txt="new", b_txt="more")
    write(tmp_path, a_txt="newer")
    # What the next results lack is gone with the earlier ones; what is not of ours stays.
    assert visible(tmp_path) == {"a.txt": "newer", "mine.txt": "keep"}


def test_results_that_are_cut_in_two_are_still_ours_and_not_whole(tmp_path, monkeypatch):
    write(tmp_path, a_txt="0", b_txt="0")
    replace, moved = os.replace, []

    def dies(source, place):
        if place.name in ("a.txt", "b.txt"):
            moved.append(place.name)
        if len(moved) == 2:
            raise OSError("no power")
        replace(source, place)

    monkeypatch.setattr(result_folder.os, "replace", dies)
    with pytest.raises(OSError, match="no power"):
        write(tmp_path, a_txt="1", b_txt="1")
    monkeypatch.undo()
    with result_folder.opened(tmp_path, contents(seed=0), keep=False) as folder:
        assert not folder.same
    write(tmp_path, keep=False, a_txt="2", b_txt="2")
    assert visible(tmp_path) == {"a.txt": "2", "b.txt": "2"}


def test_results_that_were_not_announced_are_an_error_of_ours(tmp_path):
    with pytest.raises(AssertionError, match=r"not announced: c\.txt"):
        write(tmp_path, c_txt="?")
    assert visible(tmp_path) == {}


def test_what_killed_commands_left_is_swept(tmp_path):
    (tmp_path / ".partial-1234").mkdir()
    (tmp_path / ".partial-1234" / "a.txt").write_text("half")
    (tmp_path / ".partial-99-ab").write_text("half")
    write(tmp_path, a_txt="whole")
    assert sorted(file.name for file in tmp_path.iterdir()) == [".results", "a.txt"]


@pytest.mark.parametrize("name", ["a.txt", "part_3.png"])
def test_files_of_the_user_under_our_names_are_never_touched(tmp_path, name):
    (tmp_path / name).write_text("mine")
    for keep in (True, False):
        with pytest.raises(InputError, match="is in the place of our results and none of them; move it"):
            write(tmp_path, keep=keep, a_txt="ours")
    assert visible(tmp_path) == {name: "mine"}


def test_other_results_are_kept_unless_they_may_be_replaced(tmp_path):
    write(tmp_path, contents(seed=0, field={"width": 1.0}), a_txt="0", b_txt="0")
    other = contents(seed=3, field={"width": 1.0})
    with pytest.raises(InputError, match=r"holds another study \(seed 0 there and 3 here\); --overwrite replaces it"):
        write(tmp_path, other, a_txt="3")
    with pytest.raises(InputError, match="holds results of study; --overwrite"):
        write(tmp_path, contents("drive"), a_txt="3")
    assert visible(tmp_path) == {"a.txt": "0", "b.txt": "0"}
    write(tmp_path, other, keep=False, a_txt="3")
    assert visible(tmp_path) == {"a.txt": "3"}


def test_the_same_and_the_whole_results_are_told(tmp_path):
    write(tmp_path, contents(seed=0, limits=(1.0, float("inf"))), a_txt="0", b_txt="0")
    with result_folder.opened(tmp_path, contents(limits=(1.0, float("inf")), seed=0), keep=True) as folder:
        assert folder.same
        assert folder.whole
    (tmp_path / "b.txt").unlink()
    with result_folder.opened(tmp_path, contents(seed=0, limits=(1.0, float("inf"))), keep=True) as folder:
        assert folder.same
        assert not folder.whole
    (tmp_path / "a.txt").unlink()  # who deletes results needs no leave for others
    write(tmp_path, contents(seed=1), a_txt="1")


def test_what_is_attached_goes_with_the_results(tmp_path):
    write(tmp_path, a_txt="0")
    (tmp_path / "tables").mkdir()
    for name in ("page.html", "tables/rows.csv"):
        (tmp_path / name).write_text("0")
    result_folder.attach(tmp_path, ["page.html", "tables/rows.csv"])
    result_folder.require_ours(tmp_path, "tables/*.csv")
    (tmp_path / "tables" / "mine.csv").write_text("mine")
    with pytest.raises(InputError, match=r"mine\.csv is in the place of our results"):
        result_folder.require_ours(tmp_path, "tables/*.csv")
    write(tmp_path, keep=False, a_txt="1")
    assert sorted(file.name for file in tmp_path.rglob("*")) == [".results", "a.txt", "mine.csv", "tables"]


@pytest.mark.parametrize("listed", ["../outside.txt", "/outside.txt", "sub/../../outside.txt"])
def test_an_edited_list_deletes_nothing_elsewhere(tmp_path, listed):
    folder = tmp_path / "results"
    write(folder, a_txt="0")
    outside = tmp_path / "outside.txt"
    outside.write_text("mine")
    name = str(outside) if listed.startswith("/") else listed
    (folder / "sub").mkdir()
    text = json.loads((folder / ".results").read_text())
    (folder / ".results").write_text(json.dumps({**text, "files": [*text["files"], name]}))
    write(folder, a_txt="1")
    assert outside.read_text() == "mine"


@pytest.mark.parametrize("text", ["a.txt\n", "{", '{"command": 3}'])
def test_lists_of_older_versions_and_broken_ones(tmp_path, text):
    """Names alone are files of ours; of a list that cannot be read nothing is."""
    (tmp_path / "a.txt").write_text("old")
    (tmp_path / ".results").write_text(text)
    told = "holds results of another version" if text.startswith("a") else "none of them; move it"
    with pytest.raises(InputError, match=told):
        write(tmp_path, a_txt="new")


HOLD = """
import pathlib, sys, time
from dynabot_mj.host import result_folder
with result_folder.locked(pathlib.Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(600)
"""


@pytest.mark.parametrize("place", [".", "film.mp4"])
def test_two_commands_do_not_work_at_one_place_and_a_killed_one_frees_it(tmp_path, monkeypatch, place):
    place = tmp_path / place
    with subprocess.Popen([sys.executable, "-c", HOLD, place], stdout=subprocess.PIPE, text=True) as other:
        assert other.stdout.readline() == "held\n"
        monkeypatch.setattr(result_folder, "WAIT", 0.2)
        busy = pytest.raises(InputError, match=r"another command works at .*; it has not ended within 0\.2 s")
        with busy, result_folder.locked(place):
            pass
        other.kill()
    monkeypatch.setattr(result_folder, "WAIT", 60.0)
    with result_folder.locked(place):
        pass
    assert list(tmp_path.iterdir()) == []
