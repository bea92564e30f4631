"""How a trial is filmed."""

from dataclasses import dataclass
from typing import Literal, get_args

Camera = Literal["orbit", "top", "chase"]
Overlay = Literal["trails", "beliefs", "forces", "links", "marks", "strip"]
CAMERAS: tuple[Camera, ...] = get_args(Camera)
OVERLAYS: tuple[Overlay, ...] = get_args(Overlay)


@dataclass(frozen=True, kw_only=True)
class Shot:
    """What is drawn over the scene, from where, and how fast it passes."""

    width: int = 1280  # [pixels], even as H.264 wants it
    height: int = 720
    rate: float = 30.0  # frames per second
    speed: float = 1.0  # simulated seconds per second
    camera: Camera = "orbit"
    eyes_of: int | None = None  # robot whose beliefs of its neighbours are shown, from 0; None: each one's of itself
    follow: int = 0  # robot that the camera `chase` follows, from 0
    samples: int = 0  # per pixel, against jagged edges, as many as the driver has; each takes time
    overlays: frozenset[Overlay] = frozenset(OVERLAYS)

    @property
    def interval(self) -> float:
        """Between two frames, in the simulation's time [s]."""
        return self.speed / self.rate

    @property
    def strip_height(self) -> int:
        """Of the strip below the scene [pixels], even."""
        return 2 * round(0.5 * min(0.11 * self.height, self.width / 16.0)) if "strip" in self.overlays else 0

    @property
    def scene_height(self) -> int:
        """Of the scene above it [pixels]."""
        return self.height - self.strip_height
