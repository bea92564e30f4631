"""Progress on standard error: a live bar on a terminal, now and then a line elsewhere."""

import contextlib
import sys
import time
from collections.abc import Callable, Iterator

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn

_LINE_INTERVAL = 15.0  # between two lines where there is no terminal [s]


@contextlib.contextmanager
def shown(title: str, frames: int = 0) -> Iterator[Callable[[float], None]]:
    """Yields a function that takes the share of the work that is done.

    Args:
        title: Of the work.
        frames: That it consists of, to tell how many are done per second; 0: of none.
    """
    if sys.stderr is None:  # closed
        yield lambda share: None
        return
    if sys.stderr.isatty():
        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            TaskProgressColumn(),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(elapsed_when_finished=False),
            TextColumn("{task.fields[rate]}"),
        )
        with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
            task, start = bar.add_task(title, total=1.0, rate=""), time.monotonic()
            yield lambda share: bar.update(task, completed=share, rate=_rate(share * frames, start))
        return
    yield _Lines(title, frames).update


class _Lines:
    """Prints a line every few seconds, with an estimate of the remaining time."""

    def __init__(self, title: str, frames: int) -> None:
        self._title, self._frames, self._start, self._last = title, frames, time.monotonic(), time.monotonic()

    def update(self, share: float) -> None:
        now = time.monotonic()
        if now - self._last < _LINE_INTERVAL or not 0.0 < share < 1.0:
            return
        self._last = now
        left = (now - self._start) * (1.0 - share) / share
        rate = _rate(share * self._frames, self._start)
        text = f"{self._title}: {100.0 * share:.0f} %, about {left:.0f} s left" + f", {rate}" * bool(rate)
        print(text, file=sys.stderr, flush=True)


def _rate(frames: float, start: float) -> str:
    return f"{frames / max(time.monotonic() - start, 1e-3):.0f} frames/s" if frames else ""
