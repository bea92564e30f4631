"""Matplotlib figures as SVG that stands inside a page of HTML, beside others."""

import io
import re

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from dynabot_mj.figures.style import STYLE

_PIXELS_PER_POINT = 96.0 / 72.0
# No date and no name of a program: the same figure is the same text.
_NO_METADATA = {"Date": None, "Creator": None, "Format": None, "Type": None}


def inline(figure: Figure, name: str, told: str) -> str:
    """Returns a figure as an element of HTML and forgets it.

    Args:
        figure: Its letters become outlines, so that it looks the same where its font is missing.
        name: Put before all its ids, which have to differ between the figures of a page.
        told: What it shows, for readers who cannot see it.
    """
    file = io.StringIO()
    with plt.rc_context(STYLE):
        figure.savefig(file, format="svg", metadata=_NO_METADATA)
    plt.close(figure)
    text = file.getvalue()
    width, height = (round(72.0 * _PIXELS_PER_POINT * side) for side in figure.get_size_inches())
    text = text[text.index("<svg") :]
    # Its style sheet would hold for the whole page, which has the same rule for figures only.
    text = re.sub(r"<(style|metadata)\b.*?</\1>|<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r'(\bid="|xlink:href="#|url\(#)', rf"\g<1>{name}-", text)
    text = re.sub(r'(?<= d=")[^"]*', lambda path: _shortened(path[0]), text)
    text = re.sub(r'(?<= )width="[^"]*pt"|(?<= )height="[^"]*pt"', "", text, count=2)
    size = f"width:{width}px;min-width:{round(0.72 * width)}px;aspect-ratio:{width}/{height}"
    text = text.replace("<svg", f'<svg role="img" aria-label="{_escaped(told)}" style="{size}"', 1)
    return re.sub(r"\n\s*\n+", "\n", text)


def _shortened(path: str) -> str:
    """Returns a path with hundredths of its unit and one line, half as many letters."""
    numbers = re.sub(r"-?\d+\.\d+", lambda number: f"{float(number[0]):.2f}".rstrip("0").rstrip("."), path)
    return re.sub(r"\s*\n\s*", " ", numbers).strip()


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace('"', "&quot;").replace("<", "&lt;")
