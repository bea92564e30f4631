import io
from dataclasses import dataclass

import numpy as np
import pytest
from rich.console import Console

from dynabot_mj.commands import watching
from dynabot_mj.commands.watching import StudyWatch


@dataclass
class Part:
    label: str
    size: int
    weight: float


PARTS = [Part("a", 10, 1.0), Part("a", 10, 1.0), Part("b", 10, 2.0)]


def columns(count, formed):
    """Of trials of 80 s that form at 40 s, or not at all."""
    band = np.zeros(count)
    band[:formed] = 1.0
    return {
        "diverged": np.zeros(count, dtype=bool),
        "scores.completion_common": band,
        "scores.contact": np.full(count, np.nan),
        "scores.overturned": np.full(count, np.nan),
        "scores.formation": np.where(band == 1.0, 40.0, np.nan),
        "time": np.array([0.0, 80.0]),
    }


class Clock:
    now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


def shown(watch, width, height=40):
    out = io.StringIO()
    Console(file=out, width=width).print(watch.table(width, height))
    return [line.rstrip() for line in out.getvalue().splitlines()]


def test_remaining_time_is_by_what_was_done_since_the_start(clock):
    watch = StudyWatch("study", clock)
    watch.begin(PARTS, set())
    assert watch.left is None
    clock.now += 6.0
    watch.done(0, columns(10, 5))
    watch.share(2, 0.25)
    # 1.5 of 4 in 6 s.
    assert watch.whole == pytest.approx(1.5 / 4.0)
    assert watch.left == pytest.approx(10.0)
    assert watch.line() == "study: 38 %, about 10 s left"


def test_what_was_kept_took_no_time(clock):
    watch = StudyWatch("study", clock)
    watch.begin(PARTS, {0, 1})
    for index in (0, 1):
        watch.done(index, columns(10, 5))
    assert watch.whole == 0.5
    assert watch.left is None
    clock.now += 3.0
    watch.share(2, 0.5)
    assert watch.left == pytest.approx(3.0)
    assert watch.line() == "study: 75 %, about 3 s left, kept 2 of 3 parts"
    assert watch.rate(watch.cases["a"]) is None  # all of it kept


def test_each_case_says_its_estimate_with_an_interval(clock):
    watch = StudyWatch("study", clock)
    watch.begin(PARTS, set())
    clock.now += 5.0
    watch.done(0, columns(10, 5))
    header, *rows = shown(watch, 110)[1:]
    assert header.split() == ["case", "trials", "per", "s", "formation", "[s]", "band", "1", "m", "[%]"]
    # Five of ten formed at 40 s, the others count 80 s: 60 +- 1.96 sd / sqrt(10), with sd = 20 sqrt(10 / 9).
    assert rows[0].split() == ["a", "10/20", "2.0", "60.0", "[46.9,", "73.1]", "50", "[24,", "76]"]
    assert rows[1].split() == ["b", "0/10"]


def test_narrow_and_low_terminals_show_what_matters(clock):
    watch = StudyWatch("study", clock)
    watch.begin(PARTS, set())
    watch.done(0, columns(10, 5))
    watch.done(1, columns(10, 5))
    assert all(len(line) <= 40 for line in shown(watch, 40))
    low = shown(watch, 110, height=7)
    assert any(line.startswith("b") for line in low)  # the one that is not whole
    assert not any(line.startswith("a ") and "20/20" in line for line in low)
    assert low[-1].strip() == "and 1 more"


def test_elsewhere_a_line_comes_now_and_then(monkeypatch, capsys):
    monkeypatch.setattr(watching, "_LINE_INTERVAL", 0.0)
    with watching.shown("study") as watch:
        watch.begin(PARTS, set())
        watch.done(0, columns(10, 5))
        watch.note("a part is damaged")
    told = capsys.readouterr().err.splitlines()
    assert told[0].startswith("study: 25 %, about ")
    assert told[1] == "note: a part is damaged"
