import signal

import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.host import files


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
