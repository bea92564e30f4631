"""`dynabot video`."""

import argparse
import math
import time
from pathlib import Path
from typing import Any

from dynabot_mj.commands import parsers, results, trials
from dynabot_mj.common.exceptions import InputError

_RATES = {".mp4": (1.0, 120.0), ".gif": (1.0, 50.0)}  # a GIF counts hundredths of a second, two at least
_SPEEDS = (0.01, 100.0)
_SMALLEST, _LARGEST = (480, 270), 3840  # edges of a picture [pixels]; text is legible from there
_SAMPLES = (0, 2, 4, 8)
_DEFAULTS = {".mp4": ((1280, 720), 30.0), ".gif": ((640, 360), 15.0)}  # size and rate


def add(commands: parsers.Commands) -> None:
    """Registers the command."""
    from dynabot_mj.film.shot import CAMERAS, OVERLAYS

    command = parsers.command(commands, video, parsers.shared(), parsers.science(), trials.parser())
    command.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="an .mp4 (H.264) or a .gif (default out/video/video.mp4; with --still a .png)",
    )
    picture = command.add_argument_group("the picture")
    picture.add_argument("--camera", choices=CAMERAS, default="orbit", help="default orbit; orbit and top frame all")
    picture.add_argument("--follow", type=int, metavar="ROBOT", help="that the camera chase follows (default 1)")
    picture.add_argument(
        "--eyes-of", type=int, metavar="ROBOT", help="show where this robot, from 1, believes the others to be"
    )
    picture.add_argument("--beside", choices=["particle"], help="the same trial with point masses, in the same scene")
    picture.add_argument(
        "--hide", choices=OVERLAYS, nargs="+", default=[], metavar="OVERLAY", help=f"any of {', '.join(OVERLAYS)}"
    )
    picture.add_argument(
        "--speed", type=float, help="simulated seconds per second (default 1; single messages are seen at 0.1)"
    )
    picture.add_argument("--rate", type=float, help="frames per second (default 30; of a .gif 15)")
    picture.add_argument(
        "--size", type=_size, metavar="WIDTHxHEIGHT", help="in pixels (default 1280x720; of a .gif 640x360)"
    )
    picture.add_argument(
        "--samples",
        type=int,
        choices=_SAMPLES,
        help="per pixel at most, against jagged edges; slow (default 0; of a --still 4)",
    )
    picture.add_argument("--still", type=float, metavar="TIME", help="a .png of this instant [s] instead of a video")


def video(options: argparse.Namespace) -> None:
    """One trial of one case as a video, drawn without a display."""
    from dynabot_mj.study import scenario

    setup = trials.chosen(options)
    path, duration = _path(options), scenario.duration(setup)
    if options.still is not None and not 0.0 <= options.still <= duration:
        raise InputError(f"--still {options.still:g} given, the trial lasts from 0 to {duration:g} s")
    shot = _shot(options, setup, path)

    from dynabot_mj.film import take
    from dynabot_mj.host import files, opengl, progress, result_folder

    opengl.require()
    files.require_writable(path.parent)
    begin = time.monotonic()
    with result_folder.locked(path):
        with progress.shown("simulation") as tell:
            taken = take.take(setup, shot, options.beside is not None, tell)
        trials.tell_identical(options, trials.final(taken.recording))
        document = {"file": str(path), "simulation_s": round(time.monotonic() - begin, 3)}
        if options.still is not None:
            drawn_at = _still(taken, shot, options.still, path)
            document |= {"width": shot.width, "height": shot.height, "time_s": drawn_at}
            results.show(options, document, f"{path}: {shot.width}x{shot.height} at {drawn_at:g} s")
            return
        drawing = _film(taken, shot, path)
    document |= {
        "width": shot.width,
        "height": shot.height,
        "frames": taken.frames,
        "duration_s": taken.frames / shot.rate,
        "bytes": path.stat().st_size,
        "frames_per_second": round(taken.frames / drawing, 1),
    }
    text = (
        f"{path}: {taken.frames / shot.rate:.1f} s of {shot.width}x{shot.height}, {path.stat().st_size / 1e6:.1f} MB; "
        f"{taken.frames} frames at {taken.frames / drawing:.0f} frames/s"
    )
    results.show(options, document, text)


def _film(taken: Any, shot: Any, path: Path) -> float:
    """Draws and encodes all frames, and returns how long that took [s]."""
    from dynabot_mj.film import encoder, film
    from dynabot_mj.host import progress

    begin = time.monotonic()
    with film.opened(taken, shot) as drawn, progress.shown("video", taken.frames) as tell:
        encoder.write(path, drawn.frames(tell), shot.rate)
    return time.monotonic() - begin


def _still(taken: Any, shot: Any, instant: float, path: Path) -> float:
    """Draws the frame that is nearest to an instant, and returns its time [s]."""
    import io

    import imageio.v3 as imageio

    from dynabot_mj.film import film
    from dynabot_mj.host import files

    k = round(instant / shot.interval)
    with film.opened(taken, shot) as drawn:
        picture = drawn.frame(k)
    content = io.BytesIO()
    imageio.imwrite(content, picture, extension=".png")
    files.write(path, content.getvalue())
    return round(float(taken.recording.time[k]), 9)


def _path(options: argparse.Namespace) -> Path:
    """Returns the file that is written.

    Raises:
        InputError: If its name has no suffix that is understood, or it is a folder.
    """
    from dynabot_mj.film.encoder import SUFFIXES

    suffixes = SUFFIXES if options.still is None else (".png",)
    path: Path = options.out or Path("out/video/video").with_suffix(suffixes[0])
    if path.is_dir():
        raise InputError(f"--out {path} given, it is a folder")
    if path.suffix.lower() not in suffixes:
        raise InputError(f"--out {path} given, it must be a file whose name ends with {' or '.join(suffixes)}")
    return path


def _shot(options: argparse.Namespace, setup: Any, path: Path) -> Any:
    """Returns how it is filmed.

    Raises:
        InputError: If a value is out of range, or two do not go together.
    """
    from dynabot_mj.film.shot import OVERLAYS, Shot
    from dynabot_mj.study import scenario

    size, rate = _DEFAULTS.get(path.suffix.lower(), _DEFAULTS[".mp4"])
    size, rate = options.size or size, rate if options.rate is None else options.rate
    speed = 1.0 if options.speed is None else options.speed
    if options.still is None:
        _require_rates(path, rate, speed, scenario.duration(setup))
    elif options.rate is not None or options.speed is not None:
        raise InputError(f"--{'speed' if options.rate is None else 'rate'} given with --still, which is one picture")
    elif options.still * rate >= 1.0:
        rate = round(options.still * rate) / options.still  # so that it is the time of a frame
    if options.follow is not None and options.camera != "chase":
        raise InputError(f"--follow given with --camera {options.camera}; it is the camera chase that follows a robot")
    for name in ("follow", "eyes_of"):
        number = getattr(options, name)
        if number is not None and not 1 <= number <= setup.robots:
            raise InputError(f"--{name.replace('_', '-')} {number} given, the robots are 1 to {setup.robots}")
    if options.beside in setup.plants:
        raise InputError(f"--beside {options.beside} given with --plant {options.beside}: they are the same")
    if options.eyes_of is not None and "beliefs" in options.hide:
        raise InputError("--eyes-of given with --hide beliefs, which hides what it shows")
    return Shot(
        width=size[0],
        height=size[1],
        rate=rate,
        speed=speed,
        camera=options.camera,
        eyes_of=None if options.eyes_of is None else options.eyes_of - 1,
        follow=(options.follow or 1) - 1,
        samples=(0 if options.still is None else 4) if options.samples is None else options.samples,
        overlays=frozenset(OVERLAYS) - frozenset(options.hide),
    )


def _require_rates(path: Path, rate: float, speed: float, duration: float) -> None:
    """Judges how fast frames follow each other.

    Raises:
        InputError: If that is out of range, or there is but one.
    """
    for name, value, (least, most) in (("rate", rate, _RATES[path.suffix.lower()]), ("speed", speed, _SPEEDS)):
        if not least <= value <= most:  # NaN neither
            raise InputError(f"--{name} {value:g} given, allowed are {least:g} to {most:g} for {path.suffix}")
    if math.ceil(duration / speed * rate) < 2:
        raise InputError(
            f"a trial of {duration:g} s at --speed {speed:g} and --rate {rate:g} is a single frame; --still makes one"
        )


def _size(text: str) -> tuple[int, int]:
    try:
        width, height = (int(part) for part in text.lower().split("x"))
    except ValueError:
        width = height = 0
    edges = zip((width, height), _SMALLEST, strict=True)
    if not all(least <= edge <= _LARGEST and edge % 2 == 0 for edge, least in edges):
        raise argparse.ArgumentTypeError(
            f"{text!r} given, it must be e.g. 1280x720: even numbers from {_SMALLEST[0]}x{_SMALLEST[1]} to {_LARGEST}"
        )
    return width, height
