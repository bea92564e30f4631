"""How a solver is watched: its iterations, its best point, and signals that come while compiled code runs."""

import contextlib
import math
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import casadi
import numpy as np

Progress = Callable[[int, float], None]  # told the iteration and its cost


@contextlib.contextmanager
def held_back(came: list[int]) -> Iterator[None]:
    """Notes the signals that end a program in `came` while compiled code runs, which would swallow what they raise.

    They are raised again afterwards, for whoever takes them.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread takes signals
        return
    ending = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
    # One that is ignored stays so.
    handlers = {one: signal.getsignal(one) for one in ending if signal.getsignal(one) is not signal.SIG_IGN}
    for one in handlers:
        signal.signal(one, lambda number, frame: came.append(number))
    try:
        yield
    finally:
        for one, handler in handlers.items():
            signal.signal(one, handler)
    if came:
        signal.raise_signal(came[0])


class Watch(casadi.Callback):
    """Tells the progress of the solver, and stops it on Ctrl-C."""

    def __init__(self, size: int, progress: Progress) -> None:
        """Has seen nothing yet.

        Args:
            size: Of the solver's unknowns.
            progress: Called with every iteration.
        """
        casadi.Callback.__init__(self)
        self._size, self._progress = size, progress
        self.history: list[float] = []
        self.lowest, self.best = math.inf, np.zeros(size)
        self.interrupted = False
        self.came: list[int] = []  # signals that end the program
        self.construct("watch", {})

    def get_n_in(self) -> int:
        """Tells CasADi the number of arguments."""
        return int(casadi.nlpsol_n_out())

    def get_n_out(self) -> int:
        """Tells CasADi the number of results."""
        return 1

    def get_name_in(self, index: int) -> str:
        """Tells CasADi an argument's name."""
        return str(casadi.nlpsol_out(index))

    def get_sparsity_in(self, index: int) -> casadi.Sparsity:
        """Tells CasADi an argument's shape."""
        name = casadi.nlpsol_out(index)
        size = {"f": 1, "x": self._size, "lam_x": self._size}.get(name, 0)
        return casadi.Sparsity.dense(size, 1) if size else casadi.Sparsity(0, 1 if name in ("g", "lam_g") else 0)

    def eval(self, arguments: Sequence[Any]) -> list[Any]:
        """Takes an iteration's result; anything but 0 stops the solver."""
        result = {casadi.nlpsol_out(index): value for index, value in enumerate(arguments)}
        self.history.append(float(result["f"]))
        if self.history[-1] < self.lowest:
            self.lowest, self.best = self.history[-1], np.array(result["x"]).ravel()
        try:
            self._progress(len(self.history) - 1, self.history[-1])
        except KeyboardInterrupt:
            self.interrupted = True
        return [int(self.interrupted or bool(self.came))]
