"""How a study goes, while it goes: on a terminal a line for each case, elsewhere a line for all now and then."""

import contextlib
import math
import sys
import time
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from rich.console import Console
from rich.live import Live
from rich.table import Table

from dynabot_mj.common import intervals, tables
from dynabot_mj.common.columns import Columns
from dynabot_mj.formation import metrics
from dynabot_mj.study.chunk import Chunk
from dynabot_mj.study.execution import ShareWatch

_LINE_INTERVAL = 15.0  # between two lines where there is no terminal [s]
_REFRESH = 4.0  # of the terminal, per second
_NARROW = 100  # columns, below which only what matters most is shown
_COLUMNS = ("trials", "per s", "formation \\[s]", "band 1 m \\[%]")
_NARROW_COLUMNS = ("trials", "band 1 m \\[%]")
_FRAME = 6  # lines of the terminal that are no case's


@dataclass
class _Case:
    """What is known of a case so far."""

    total: int = 0
    done: int = 0
    fresh: int = 0  # of these, those that were not kept
    formed: int = 0  # with the common band at the end
    judged: int = 0
    times: float = 0.0  # sum of the restricted times to formation
    squares: float = 0.0
    timed: int = 0


class StudyWatch(ShareWatch):
    """Keeps count of a study's cases."""

    def __init__(self, title: str, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__(lambda share: self.changed())
        self.title, self._clock = title, clock
        self.cases: dict[str, _Case] = {}
        self._chunks: Sequence[Chunk] = ()
        self._kept: set[int] = set()
        self._start, self._free = clock(), 0.0  # share that was there already
        self.changed: Callable[[], None] = lambda: None

    def begin(self, chunks: Sequence[Chunk], kept: Collection[int]) -> None:
        """Counts what is to be done."""
        super().begin(chunks, kept)
        self._chunks, self._start, self._kept = chunks, self._clock(), set(kept)
        for chunk in chunks:
            self.cases.setdefault(chunk.label, _Case()).total += chunk.size
        self._free = sum(self._weights[index] for index in kept) / self._total

    def note(self, text: str) -> None:
        """Says it at once."""
        print(f"note: {text}", file=sys.stderr)

    def done(self, index: int, columns: Columns) -> None:
        """Adds the trials of a chunk to what its case says."""
        chunk = self._chunks[index]
        case = self.cases[chunk.label]
        case.done += chunk.size
        if index not in self._kept:
            case.fresh += chunk.size
        healthy = ~columns["diverged"].astype(bool)
        band = columns["scores.completion_common"][healthy]
        case.formed += int((band == 1.0).sum())
        case.judged += int(np.isfinite(band).sum())
        failure = np.fmin(columns["scores.contact"], columns["scores.overturned"])
        times = metrics.restricted(columns["scores.formation"], failure, float(columns["time"][-1]))[healthy]
        case.times, case.squares = case.times + float(times.sum()), case.squares + float((times**2).sum())
        case.timed += len(times)
        super().done(index, columns)

    @property
    def left(self) -> float | None:
        """Remaining time by what was done since the start [s]; None where nothing was."""
        done = self.whole - self._free
        return (self._clock() - self._start) * (1.0 - self.whole) / done if done > 0.0 else None

    def rate(self, case: _Case) -> float | None:
        """Trials of a case per second since the start."""
        spent = self._clock() - self._start
        return case.fresh / spent if case.fresh and spent > 0.0 else None

    def line(self) -> str:
        """Returns all of it in one line."""
        left, kept = self.left, f", kept {len(self._kept)} of {len(self._chunks)} parts" if self._kept else ""
        return f"{self.title}: {100.0 * self.whole:.0f} %{'' if left is None else f', about {left:.0f} s left'}{kept}"

    def table(self, width: int, height: int) -> Table:
        """Returns the cases, those that are not whole first where there is no room for all."""
        narrow = width < _NARROW
        table = Table(title=self.line(), title_justify="left", box=None, pad_edge=False)
        table.add_column("case", overflow="ellipsis", no_wrap=True, ratio=1)
        for name in _NARROW_COLUMNS if narrow else _COLUMNS:
            table.add_column(name, justify="right", no_wrap=True)
        cases = list(self.cases.items())
        room = max(height - _FRAME, 1)
        if len(cases) > room:
            cases = sorted(cases, key=lambda pair: pair[1].done == pair[1].total)[:room]
        for label, case in cases:
            told = [f"{case.done}/{case.total}"]
            band = tables.rate(intervals.share(case.formed, case.judged)) if case.judged else ""
            rate = self.rate(case)
            told += [band] if narrow else [f"{rate:.1f}" if rate else "", _formation(case), band]
            table.add_row(label, *told)
        if len(self.cases) > len(cases):
            table.caption = f"and {len(self.cases) - len(cases)} more"
        return table


@contextlib.contextmanager
def shown(title: str) -> Iterator[StudyWatch]:
    """Yields a watch that shows how a study goes on standard error."""
    watch = StudyWatch(title)
    if sys.stderr is None:  # closed
        yield watch
    elif sys.stderr.isatty():
        console = Console(stderr=True)
        with Live(
            get_renderable=lambda: watch.table(console.width, console.height),
            console=console,
            refresh_per_second=_REFRESH,
            transient=True,
        ):
            yield watch
    else:
        last = time.monotonic()

        def say() -> None:
            nonlocal last
            if time.monotonic() - last >= _LINE_INTERVAL and 0.0 < watch.whole < 1.0:
                last = time.monotonic()
                print(watch.line(), file=sys.stderr, flush=True)

        watch.changed = say
        yield watch


def _formation(case: _Case) -> str:
    """Returns the mean time to formation so far, with the interval of the normal law."""
    if not case.timed:
        return ""
    mean = case.times / case.timed
    if case.timed < 2:
        return f"{mean:.1f}"
    variance = max(case.squares - case.timed * mean**2, 0.0) / (case.timed - 1)
    half = 1.96 * math.sqrt(variance / case.timed)
    return f"{mean:.1f} [{mean - half:.1f}, {mean + half:.1f}]"
