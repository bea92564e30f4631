"""What a film costs: frames per second of the drawing with everything on, what each overlay takes, and the encoder.

Each picture is drawn by all variants in turn, in an order drawn by lot, and an overlay's cost is the median of what
each picture takes longer with it: so what else the machine does falls on all of them alike.
"""

import itertools
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from dynabot_mj.common.arrays import Array, Progress
from dynabot_mj.common.tables import aligned
from dynabot_mj.film import encoder, take
from dynabot_mj.film.film import Film
from dynabot_mj.film.shot import OVERLAYS, Shot
from dynabot_mj.host import opengl
from dynabot_mj.study import configuration

_SIZES = ((1280, 720), (640, 480))
_ENCODED = 120  # pictures, which are in memory at once
_DURATION = 60.0  # of the trial, from which pictures are taken evenly [s]


@dataclass(frozen=True, kw_only=True)
class DrawingRate:
    """One size of pictures."""

    width: int
    height: int
    frames_per_second: float  # drawn, everything on
    bare_per_second: float  # without any overlay
    overlays_ms: dict[str, float]  # what each one adds to a picture
    smooth_ms: float  # what four samples per pixel add
    encoded_per_second: float  # by the encoder alone


def run(robots: int, pictures: int, progress: Progress = lambda share: None) -> list[DrawingRate]:
    """Measures both sizes.

    Args:
        robots: In the trial, whose point masses are shown beside them.
        pictures: That are drawn of each variant.
        progress: Told the share of the work that is done.

    Raises:
        GraphicsError: If nothing can be drawn here.
    """
    setup = configuration.build(
        {}, plants=["rigid"], estimators=["decoupled"], trials=1, robots=robots, duration=_DURATION
    )
    shot = Shot()
    what = take.take(setup, shot, beside=True)
    chosen = np.linspace(0, what.frames - 1, pictures).round().astype(int).tolist()
    rows = []
    for done, (width, height) in enumerate(_SIZES):
        sized = replace(shot, width=width, height=height)

        def tell(share: float, done: int = done) -> None:
            progress((done + share) / len(_SIZES))

        rows.append(_row(what, sized, chosen, tell))
    return rows


def document(rows: Sequence[DrawingRate], robots: int, pictures: int) -> dict[str, Any]:
    """Returns the JSON document."""
    return {"video": {"robots": robots, "pictures": pictures, "rows": [asdict(row) for row in rows]}}


def markdown(rows: Sequence[DrawingRate], robots: int, pictures: int) -> str:
    """Returns the report as a table."""
    sizes = [f"{row.width}x{row.height}" for row in rows]
    body = [
        ["frames/s, everything on", *(f"{row.frames_per_second:.0f}" for row in rows)],
        ["frames/s, no overlay", *(f"{row.bare_per_second:.0f}" for row in rows)],
        ["frames/s, encoder alone", *(f"{row.encoded_per_second:.0f}" for row in rows)],
        *([f"{name} [ms]", *(f"{round(row.overlays_ms[name], 1) + 0.0:.1f}" for row in rows)] for name in OVERLAYS),
        ["four samples per pixel [ms]", *(f"{row.smooth_ms:.1f}" for row in rows)],
    ]
    lines = [
        f"# Cost of a film, {robots} robots and as many point masses beside them",
        "",
        *aligned(["", *sizes], body),
        "",
        f"Medians over {pictures} pictures of a trial of {_DURATION:.0f} s, camera orbit. The strip makes the scene",
        "above it smaller, so it may cost less than nothing.",
    ]
    return "\n".join(lines) + "\n"


def _row(what: take.Take, shot: Shot, chosen: Sequence[int], progress: Progress) -> DrawingRate:
    every = frozenset(OVERLAYS)
    variants = [shot, *(replace(shot, overlays=every - {name}) for name in OVERLAYS)]
    variants.append(replace(shot, overlays=frozenset()))
    with opengl.context(shot.width, shot.height):
        spent = _drawn(what, variants, chosen, lambda share: progress(0.7 * share))
        film = Film(what, shot)
        encoded = _encoded_per_second(film)
        film.free()
    # By itself: with another number of samples from picture to picture, the driver compiles anew each time.
    with opengl.context(shot.width, shot.height):
        smooth = _drawn(what, [replace(shot, samples=4)], chosen, lambda share: progress(0.7 + 0.3 * share))
    typical: Array = np.median(spent, axis=0)
    saved = np.median(spent[:, :1] - spent, axis=0)
    return DrawingRate(
        width=shot.width,
        height=shot.height,
        frames_per_second=float(1.0 / typical[0]),
        bare_per_second=float(1.0 / typical[-1]),
        overlays_ms={name: float(1e3 * saved[1 + index]) for index, name in enumerate(OVERLAYS)},
        smooth_ms=float(1e3 * (np.median(smooth) - typical[0])),
        encoded_per_second=encoded,
    )


def _drawn(what: take.Take, variants: Sequence[Shot], chosen: Sequence[int], progress: Progress) -> Array:
    """Returns how long each picture takes in each variant, (pictures, variants) [s]."""
    films = [Film(what, variant) for variant in variants]
    spent = np.empty((len(chosen), len(films)))
    generator = np.random.default_rng(0)
    for film in films:
        film.frame(0)
    for row, k in enumerate(chosen):
        # What was drawn before matters: the driver frees and clears then.
        for index in generator.permutation(len(films)):
            begin = time.perf_counter()
            films[index].frame(k)
            spent[row, index] = time.perf_counter() - begin
        progress((row + 1) / len(chosen))
    for film in films:
        film.free()
    return spent


def _encoded_per_second(film: Film) -> float:
    """Returns how many pictures the encoder takes per second, all of them drawn before."""
    pictures = list(itertools.islice(film.frames(), _ENCODED))
    with tempfile.TemporaryDirectory() as folder:
        begin = time.perf_counter()
        encoder.write(Path(folder) / "film.mp4", pictures, film.shot.rate)
        return len(pictures) / (time.perf_counter() - begin)
