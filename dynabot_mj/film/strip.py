"""The strip below the scene, with the trial's figures, and the robots' numbers."""

import functools
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont

from dynabot_mj.common.arrays import Array
from dynabot_mj.common.legend import PERCEPTION_NAMES, ROBOT_COLOURS
from dynabot_mj.film.shot import Shot
from dynabot_mj.film.take import Take
from dynabot_mj.perception import methods
from dynabot_mj.plants.kinds import KINDS
from dynabot_mj.study import scenario

Picture = npt.NDArray[np.uint8]

_BACKGROUND, _RULE = "#14181D", "#2B333C"
_LABEL_COLOUR, _VALUE_COLOUR, _ALARM_COLOUR, _DONE_COLOUR = "#9AA7B4", "#F2F5F7", "#FF7B72", "#D9A900"
_LABEL_SIZE, _VALUE_SIZE = 0.19, 0.34  # of the strip's height
_NARROW = 1.55  # of a strip: its height times this many per column


class Strip:
    """Draws the strip of each frame; what stays the same is drawn once."""

    def __init__(self, what: Take, shot: Shot) -> None:
        """Lays out the columns."""
        self._take, self._shot = what, shot
        self._height = shot.strip_height
        self._label_font = _font(max(9.0, _LABEL_SIZE * self._height))
        self._value_font = _font(max(11.0, _VALUE_SIZE * self._height))
        self._gap = round(0.36 * self._height)
        self._base = Image.new("RGB", (shot.width, self._height), _BACKGROUND)
        self._write = ImageDraw.Draw(self._base)
        one = what.recording
        case = one.case
        _, control_ticks = scenario.periods(one.setup, case.estimator)
        method = methods.label(case.estimator)
        kind = PERCEPTION_NAMES[case.perception] if case.perception else KINDS[case.plant].label
        columns = [
            ("time", "000.0 s", self._time),
            (kind, method, None),
            ("T_c", f"{1e3 * control_ticks * one.setup.processor.tick:.0f} ms", None),
            ("min. distance", "00.00 m", self._closest),
        ]
        self._changing: list[tuple[int, Callable[[int], tuple[str, str]]]] = []
        x = self._gap
        for label, widest, changing in columns:
            self._write.text((x, self._y(0.16)), label, _LABEL_COLOUR, self._label_font)
            if changing is None:
                self._write.text((x, self._y(0.46)), widest, _VALUE_COLOUR, self._value_font)
            else:
                self._changing.append((x, changing))
            width = max(self._value_font.getlength(widest), self._label_font.getlength(label))
            x += round(width) + self._gap
        self._leader_x = x
        room = shot.width - self._gap - x
        self._note = self._as_room_allows(
            [
                *([f"as robot {shot.eyes_of + 1} believes"] if shot.eyes_of is not None else []),
                *(["dashed: point masses"] if what.beside else []),
                *([f"slope {one.setup.vehicle.slope:g}"] if one.setup.vehicle.slope else []),
                f"speed x{shot.speed:g}",
                f"trial {one.trial}",
                "squares 1 m, lines 10 m",
            ],
            room,
        )
        label = "distance to leader [m]"
        if self._label_font.getlength(label) + self._label_font.getlength(self._note) + self._gap < room:
            self._write.text((x, self._y(0.16)), label, _LABEL_COLOUR, self._label_font)

    def draw(self, k: int) -> Picture:
        """Returns the strip of a frame, (height, width, 3)."""
        image = self._base.copy()
        pen = ImageDraw.Draw(image)
        done = self._take.recording.time[k] / scenario.duration(self._take.recording.setup)
        pen.rectangle((0, 0, self._shot.width, 2), _RULE)
        pen.rectangle((0, 0, round(done * self._shot.width), 2), _DONE_COLOUR)
        for x, changing in self._changing:
            text, colour = changing(k)
            pen.text((x, self._y(0.46)), text, colour, self._value_font)
        self._distances(pen, k)
        return np.asarray(image)

    def _distances(self, pen: ImageDraw.ImageDraw, k: int) -> None:
        """Writes each robot's distance to the leader [m] behind its colour, as far apart as there is room."""
        right = self._shot.width - self._gap
        note, colour = ("COLLISION", _ALARM_COLOUR) if self._take.collided[k].any() else (self._note, _LABEL_COLOUR)
        pen.text((right, self._y(0.16)), note, colour, self._label_font, anchor="ra")
        one = self._take.recording
        distance = np.hypot(*one.position_w[k].T)
        each = min((right - self._leader_x) // len(distance), round(_NARROW * self._height))
        dot = max(3, round(0.09 * self._height))
        for robot, metres in enumerate(distance):
            x, y = self._leader_x + robot * each, self._y(0.46)
            middle = y + round(0.62 * self._value_font.size)
            pen.ellipse(
                (x, middle - dot, x + 2 * dot, middle + dot), ROBOT_COLOURS[robot], outline=_VALUE_COLOUR, width=1
            )
            pen.text((x + 3 * dot, y), f"{metres:.1f}", _VALUE_COLOUR, self._value_font)

    def _time(self, k: int) -> tuple[str, str]:
        return f"{self._take.recording.time[k]:.1f} s", _VALUE_COLOUR

    def _closest(self, k: int) -> tuple[str, str]:
        """Returns the smallest distance of any two robots since the frame before, alarming where they collide."""
        one = self._take.recording
        closest = float(one.closest[k])
        alarming = bool(one.near[k].any() or one.overlapping[k].any())
        return f"{closest:.2f} m", _ALARM_COLOUR if alarming else _VALUE_COLOUR

    def _as_room_allows(self, parts: list[str], room: float) -> str:
        """Returns the first of the parts that have room together [pixels]."""
        while parts and self._label_font.getlength(", ".join(parts)) > room:
            parts = parts[:-1]
        return ", ".join(parts)

    def _y(self, share: float) -> int:
        return round(share * self._height)


class Numbers:
    """The robots' numbers, beside their colours for those who cannot tell them apart."""

    def __init__(self, robots: int, height: int) -> None:
        """Draws them once, for a picture of a height [pixels]."""
        self._badges = [_badge(robot, max(16, 2 * round(height / 64))) for robot in range(robots)]

    def draw(self, picture: Picture, places: Array) -> None:
        """Puts numbers into a picture.

        Args:
            picture: (H, W, 3).
            places: Above which they stand, (n, 2), right and up from -1 to 1; NaN: not in the picture.
        """
        height, width, _ = picture.shape
        for badge, (right, up) in zip(self._badges, places, strict=True):
            if not (abs(right) < 1.0 and abs(up) < 1.0):
                continue
            size = badge.shape[0]
            left = round(0.5 * (right + 1.0) * width) - size // 2
            top = round(0.5 * (1.0 - up) * height) - size
            left, top = min(max(left, 0), width - size), min(max(top, 0), height - size)
            part = picture[top : top + size, left : left + size]
            opacity = badge[..., 3:].astype(np.float32) / 255.0
            part[:] = (part + opacity * (badge[..., :3] - part.astype(np.float32))).astype(np.uint8)


def _badge(robot: int, size: int) -> Picture:
    """Returns a number on a disc of the robot's colour, (size, size, 4)."""
    scale = 4  # drawn larger and made smaller: PIL's discs have jagged edges
    image = Image.new("RGBA", (scale * size, scale * size), (255, 255, 255, 0))
    pen = ImageDraw.Draw(image)
    pen.ellipse((scale, scale, scale * (size - 1), scale * (size - 1)), ROBOT_COLOURS[robot], "white", 2 * scale)
    middle = scale * size / 2.0
    pen.text((middle, middle), str(robot + 1), "white", _font(0.62 * scale * size), anchor="mm")
    return np.asarray(image.resize((size, size), Image.Resampling.LANCZOS))


@functools.cache
def _font(size: float) -> ImageFont.FreeTypeFont:
    font = ImageFont.load_default(size)
    assert isinstance(font, ImageFont.FreeTypeFont)  # Pillow without FreeType has bitmaps of one size only
    return font
