"""Pictures into a file, one after the other: ffmpeg encodes in a process of its own while the next one is drawn."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np

from dynabot_mj.common.exceptions import DynabotError
from dynabot_mj.film.strip import Picture
from dynabot_mj.host import files

SUFFIXES = (".mp4", ".gif")

_QUALITY: dict[str, dict[str, Any]] = {
    # What browsers play; the index at the file's beginning, so that they need not have all of it to start; and colours
    # by the standard that players take for granted, stated as well.
    ".mp4": {
        "codec": "libx264",
        "pix_fmt_out": "yuv420p",
        "output_params": [
            *("-crf", "21", "-preset", "veryfast", "-movflags", "+faststart"),
            *("-vf", "scale=out_color_matrix=bt709:out_range=tv"),
            *("-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"),
        ],
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
        path: Ends with one of SUFFIXES, in any case; this process is the only one that writes it.
        pictures: At least one, (H, W, 3) each, H and W even.
        rate: Pictures per second.

    Raises:
        DynabotError: If the encoder fails.
    """
    # Absolute, since to the encoder `12:30.mp4` is a protocol.
    partial = path.absolute().with_name(f"{files.PARTIAL}{files.short(path.name)}{path.suffix.lower()}")
    try:
        count = _encode(partial, pictures, rate)
        # The library tells neither how the encoder ended nor why.
        if not partial.is_file() or imageio_ffmpeg.count_frames_and_secs(str(partial))[0] != count:
            raise DynabotError(f"the video could not be encoded whole; is there room in {path.parent}?")
        partial.replace(path)
    except (OSError, RuntimeError) as error:  # the pipe breaks; there is no encoder
        reason = (str(error).strip() or type(error).__name__).splitlines()[0]
        raise DynabotError(f"the video could not be encoded ({reason}); is there room in {path.parent}?") from error
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
                    str(path),
                    size,
                    fps=rate,
                    quality=None,
                    macro_block_size=2,
                    ffmpeg_log_level="quiet",
                    **_QUALITY[path.suffix],
                )
                encoder.send(None)  # starts it
            encoder.send(np.ascontiguousarray(picture))
            count += 1
    finally:
        if encoder is not None:
            encoder.close()  # and waits for what is still to be encoded
    return count
