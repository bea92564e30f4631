import signal

import pytest

from dynabot_mj import files
from dynabot_mj.errors import InputError


def test_results_appear_only_when_all_are_complete(tmp_path):
    (tmp_path / "a.txt").write_text("old")

    def interrupted():
        with files.staged(tmp_path) as stage:
            (stage / "a.txt").write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert [(file.name, file.read_text()) for file in tmp_path.iterdir()] == [("a.txt", "old")]
    (tmp_path / "mine.txt").write_text("keep")
    with files.staged(tmp_path) as stage:
        (stage / "a.txt").write_text("new")
        (stage / "b.txt").write_text("more")
    with files.staged(tmp_path) as stage:
        (stage / "a.txt").write_text("newer")
    # What the next results lack is gone with the earlier ones; what is not of ours stays.
    visible = {file.name: file.read_text() for file in tmp_path.iterdir() if file.name != ".results"}
    assert visible == {"a.txt": "newer", "mine.txt": "keep"}


def test_an_unwritable_folder_is_refused(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="cannot write to the folder"):
        files.require_writable(tmp_path / "file" / "below")
    files.require_writable(tmp_path / "new" / "deep")
    assert list((tmp_path / "new" / "deep").iterdir()) == []


def test_ctrl_c_is_put_off_not_lost():
    steps = []

    def work():
        with files.uninterrupted():
            signal.raise_signal(signal.SIGINT)
            steps.append("done")

    with pytest.raises(KeyboardInterrupt):
        work()
    assert steps == ["done"]
