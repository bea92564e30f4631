import gc

import imageio.v3 as imageio
import numpy as np
import pytest
from PIL import Image

from dynabot_mj.common.exceptions import DynabotError
from dynabot_mj.film import encoder

# Its library leaves pipes open: of an encoder that has failed, and of what reads a video here.
pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")


def bars(count, width=96, height=64):
    """A bar that moves to the right."""
    for k in range(count):
        picture = np.full((height, width, 3), 200, dtype=np.uint8)
        picture[:, k * 4 : k * 4 + 8] = (20, 60, 160)
        yield picture


def test_a_video_has_its_frames_its_rate_and_the_codec_that_browsers_play(tmp_path):
    path = tmp_path / "bars.mp4"
    encoder.write(path, bars(20), 10.0)
    about = imageio.immeta(path, plugin="FFMPEG")
    assert about["codec"] == "h264"
    assert about["pix_fmt"].startswith("yuv420p(tv, bt709")  # the colours that players take for granted
    assert about["size"] == (96, 64)
    assert about["fps"] == 10.0
    assert about["duration"] == pytest.approx(2.0)
    shown = imageio.imread(path, plugin="FFMPEG")
    assert shown.shape == (20, 64, 96, 3)
    for k in (0, 10, 19):
        assert np.abs(shown[k].astype(int) - list(bars(20))[k]).mean() < 12
    content = path.read_bytes()
    assert content.index(b"moov") < content.index(b"mdat")  # it starts to play before all of it has come
    assert list(tmp_path.iterdir()) == [path]


def test_an_animation_has_its_frames_and_repeats(tmp_path):
    path = tmp_path / "bars.gif"
    encoder.write(path, bars(12), 20.0)
    with Image.open(path) as animation:
        assert animation.n_frames == 12
        assert animation.info["loop"] == 0
        assert animation.info["duration"] == 50
        animation.seek(11)
        shown = np.asarray(animation.convert("RGB")).astype(int)
    assert np.abs(shown - list(bars(12))[11]).mean() < 3


def test_what_is_interrupted_leaves_nothing_and_the_earlier_file(tmp_path):
    path = tmp_path / "bars.mp4"
    path.write_bytes(b"earlier")

    def interrupted():
        yield from bars(5)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        encoder.write(path, interrupted(), 10.0)
    assert path.read_bytes() == b"earlier"
    assert list(tmp_path.iterdir()) == [path]


def test_an_encoder_that_fails_is_told_in_one_line(tmp_path, monkeypatch):
    monkeypatch.setitem(encoder._QUALITY[".mp4"], "codec", "nonsense")
    with pytest.raises(DynabotError, match="the video could not be encoded") as raised:
        encoder.write(tmp_path / "bars.mp4", bars(50), 10.0)
    assert "\n" not in str(raised.value)
    assert list(tmp_path.iterdir()) == []


@pytest.fixture(autouse=True)
def pipes_are_collected_here():
    yield
    gc.collect()


def test_without_an_encoder_that_is_told(tmp_path, monkeypatch):
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(tmp_path / "none"))
    with pytest.raises(DynabotError, match=r"the video could not be encoded \(.*none"):
        encoder.write(tmp_path / "bars.mp4", bars(3), 10.0)
