"""How all figures look, and how they are written."""

import io
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # the back end has to be chosen before
from matplotlib.figure import Figure
from PIL import Image

# Matplotlib's own defaults first: a user's matplotlibrc is about the user's figures, and may ask for a missing LaTeX.
STYLE: dict[Any, Any] = {
    **{
        key: value
        for key, value in matplotlib.rcParamsDefault.items()
        if not key.startswith(("backend", "interactive"))
    },
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#E3E3E3",
    "axes.axisbelow": True,
    "legend.frameon": False,
    "figure.dpi": 120,
    # Without these, the same figure is not the same file.
    "svg.hashsalt": "dynabot",
}


def save(figure: Figure, path: Path) -> None:
    """Writes a figure and forgets it; the format follows from the name."""
    with plt.rc_context(STYLE):
        if path.suffix == ".png":
            drawn = io.BytesIO()
            figure.savefig(drawn, format="png")
            # Lines and letters of a few colours: a palette of them is half the file.
            palette = Image.open(drawn).convert("RGB").quantize(256, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
            palette.save(path, optimize=True)
        else:
            figure.savefig(path)
    plt.close(figure)
