import re
import sys

from dynabot_mj.host import progress


def test_work_without_a_terminal_is_told_line_by_line(monkeypatch, capsys):
    monkeypatch.setattr(progress, "_LINE_INTERVAL", 0.0)
    with progress.shown("compare", frames=200) as tell:
        for share in (0.0, 0.25, 0.5, 1.0):
            tell(share)
    out, err = capsys.readouterr()
    assert out == ""
    lines = err.splitlines()
    # Nothing is known of the rest at the start, and nothing is left at the end.
    assert [line.split(",")[0] for line in lines] == ["compare: 25 %", "compare: 50 %"]
    assert all(re.fullmatch(r"compare: \d+ %, about \d+ s left, \d+ frames/s", line) for line in lines)


def test_lines_are_some_seconds_apart(capsys):
    with progress.shown("compare") as tell:
        for step in range(1000):
            tell(step / 1000)
    assert capsys.readouterr() == ("", "")


def test_a_closed_standard_error_is_no_error(monkeypatch):
    monkeypatch.setattr(sys, "stderr", None)
    with progress.shown("compare") as tell:
        tell(0.5)
