"""`dynabot view`."""

import argparse
import sys
from typing import Any

from dynabot_mj.commands import parsers, trials
from dynabot_mj.common.exceptions import DynabotError, InputError
from dynabot_mj.host import opengl

_HOST, _PORT = "127.0.0.1", 8080


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    command = parsers.command(commands, view, parsers.science(), trials.parser())
    command.add_argument("--live", action="store_true", help="simulate while showing, instead of replaying")
    command.add_argument("--speed", type=float, default=1.0, help="simulated seconds per second (default 1)")
    browser = command.add_argument_group("in the browser")
    browser.add_argument("--browser", action="store_true", help="there, even where there is a display")
    browser.add_argument("--host", help=f"address to listen on (default {_HOST}: this machine alone can look)")
    browser.add_argument("--port", type=int, help=f"to listen on (default {_PORT}; 0: any free one)")


def view(options: argparse.Namespace) -> None:
    """One trial of one case, watched: in MuJoCo's window where there is a display, else in the browser."""
    if not 0.05 <= options.speed <= 100.0:
        raise InputError(f"--speed {options.speed:g} given, allowed are 0.05 to 100")
    if options.port is not None and not 0 <= options.port <= 65535:
        raise InputError(f"--port {options.port} given, allowed are 0 to 65535")
    setup = trials.chosen(options)

    from dynabot_mj.host import progress
    from dynabot_mj.viewing import playback, recording

    in_window = not options.browser and _has_display()
    for name in ("host", "port"):
        if in_window and getattr(options, name) is not None:
            raise InputError(f"--{name} given, but there is a display, whose window needs none; or give --browser")
    if not in_window:
        _require_browser()
    snapshots = None
    if not options.live:
        with progress.shown("view") as tell:
            recorded = recording.record(setup, playback.FRAME, tell)
        trials.tell_identical(options, trials.final(recorded))
        snapshots = playback.snapshots(recorded)
    clock = playback.Clock(options.speed)
    screen = _screen(options, setup, clock, in_window)
    try:
        if options.live:
            snapshots = playback.live(setup, screen, clock)
        if snapshots is not None:
            playback.replay(snapshots, screen, clock)
    except KeyboardInterrupt:  # the way to end it, as it says
        pass
    finally:
        screen.close()


def _screen(options: argparse.Namespace, setup: Any, clock: Any, in_window: bool) -> Any:
    """Opens the window, or starts to serve a page, and says where it is."""
    from dynabot_mj.study import scenario
    from dynabot_mj.viewing.stage import Stage

    (case,) = scenario.cases(setup)
    title = f"{case.label}, trial {setup.first_trial}"
    if in_window:
        from dynabot_mj.viewing.window import Window

        print(f"{title}: in MuJoCo's window; space halts and continues, the arrows go back and ahead", flush=True)
        return Window(Stage(setup, case), clock)
    from dynabot_mj.viewing.browser import Browser

    browser = Browser(
        Stage(setup, case),
        clock,
        title=title,
        duration=scenario.duration(setup),
        host=options.host or _HOST,
        port=_PORT if options.port is None else options.port,
    )
    print(f"{title}: {browser.address} (Ctrl-C ends it)", flush=True)
    return browser


def _has_display() -> bool:
    """Tells whether a window can be opened here; on macOS that would take MuJoCo's own interpreter, `mjpython`."""
    if sys.platform == "darwin":
        return False
    if sys.platform == "linux" and not opengl.has_display():
        return False
    from dynabot_mj.viewing.window import display_answers  # imports libraries that a machine without a display may lack

    return display_answers()


def _require_browser() -> None:
    """Makes sure, before any work, that the page can be made.

    Raises:
        DynabotError: If what makes it is not installed.
    """
    try:
        import mjviser  # noqa: F401
    except ImportError as error:
        raise DynabotError("the browser needs mjviser: pip install 'dynabot-mj[view]'") from error
