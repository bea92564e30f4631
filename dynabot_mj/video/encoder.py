"""Pictures into a file, one after the other: ffmpeg encodes in a process of its own while the next one is drawn."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np

from dynabot_mj.errors import DynabotError
from dynabot_mj.video.strip import Picture

SUFFIXES = (".mp4", ".gif")

_QUALITY: dict[str, dict[str, Any]] = {
    # What browsers play; the index at the file's beginning, so that they need not have all of it to start.
    ".mp4": {
        "codec": "libx264",
        "pix_fmt_out": "yuv420p",
        "output_params": ["-crf", "21", "-preset", "veryfast", "-movflags", "+faststart"],
    },
    # A palette for each frame: one for all would have to hold all frames in memory first.
    ".gif": {
        "codec": "gif",
        "pix_fmt_out": "pal8",
        "output_params": [
            "-filter_complex",
            "split[a][b];[a]palettegen=stats_mode=single:max_colors=128[p];[b][p]paletteuse=new=1:dither=none",
        ],
    },
}


def write(path: Path, pictures: Iterable[Picture], rate: float) -> None:
    """Encodes pictures into a file that is complete or not there.

    Args:
        path: Ends with one of SUFFIXES.
        pictures: At least one, (H, W, 3) each, H and W even.
        rate: Pictures per second.

    Raises:
        DynabotError: If the encoder fails.
    """
    partial = path.with_name(f".{path.stem}.partial{path.suffix}")
    try:
        count = _encode(partial, pictures, rate)
        # The encoder tells neither how it ended nor why; with what it has to say of errors it speaks for itself.
        if not partial.is_file() or imageio_ffmpeg.count_frames_and_secs(str(partial))[0] != count:
            raise DynabotError(f"the video {path} could not be encoded")
        partial.replace(path)
    except OSError as error:
        raise DynabotError(f"the video {path} could not be encoded: {str(error).splitlines()[0]}") from error
    finally:
        partial.unlink(missing_ok=True)


def _encode(path: Path, pictures: Iterable[Picture], rate: float) -> int:
    """Streams pictures to the encoder, and returns how many they were."""
    encoder, count = None, 0
    try:
        for picture in pictures:
            if encoder is None:
                size = (picture.shape[1], picture.shape[0])
                encoder = imageio_ffmpeg.write_frames(
                    str(path), size, fps=rate, macro_block_size=2, ffmpeg_log_level="error", **_QUALITY[path.suffix]
                )
                encoder.send(None)  # starts it
            encoder.send(np.ascontiguousarray(picture))
            count += 1
    finally:
        if encoder is not None:
            encoder.close()  # and waits for what is still to be encoded
    return count
