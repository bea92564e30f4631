"""Pictures into a file, one after the other: ffmpeg encodes in a process of its own while the next one is drawn."""

import contextlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import imageio.v2 as imageio

from dynabot_mj import files
from dynabot_mj.errors import DynabotError
from dynabot_mj.video.strip import Picture

SUFFIXES = (".mp4", ".gif")

_QUALITY = {
    # What browsers play; the index at the file's beginning, so that they need not have all of it to start.
    ".mp4": {
        "codec": "libx264",
        "pixelformat": "yuv420p",
        "output_params": ["-crf", "21", "-preset", "veryfast", "-movflags", "+faststart"],
    },
    # A palette for each frame: one for all would have to hold all frames in memory first.
    ".gif": {
        "codec": "gif",
        "pixelformat": "pal8",
        "output_params": [
            "-filter_complex",
            "split[a][b];[a]palettegen=stats_mode=single:max_colors=128[p];"
            "[b][p]paletteuse=new=1:dither=none:diff_mode=rectangle",
        ],
    },
}


def write(path: Path, pictures: Iterable[Picture], rate: float) -> None:
    """Encodes pictures into a file that is complete or not there.

    Args:
        path: Ends with one of SUFFIXES.
        pictures: (H, W, 3) each, H and W even.
        rate: Pictures per second.

    Raises:
        DynabotError: If the encoder fails.
    """
    partial = path.with_name(f".{path.stem}.partial{path.suffix}")
    pictures = iter(pictures)
    try:
        with _writer(partial, path.suffix, rate) as writer:
            # The encoder is started with the first picture, and inherits that Ctrl-C is ours alone to handle.
            first = next(pictures)
            with files.uninterrupted():
                writer.append_data(first)
            for picture in pictures:
                writer.append_data(picture)
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


@contextlib.contextmanager
def _writer(path: Path, suffix: str, rate: float) -> Iterator[Any]:
    writer = imageio.get_writer(
        path, format="FFMPEG", mode="I", fps=rate, macro_block_size=2, ffmpeg_log_level="error", **_QUALITY[suffix]
    )
    try:
        with writer:
            yield writer
    except OSError as error:
        # What ffmpeg complained of stands behind the first line, which is about the pipe.
        raise DynabotError(f"the video cannot be encoded: {' '.join(str(error).split())[:300]}") from error
