"""What perceptions are called in figures, films and reports, and colours; methods and plants have records of their own.

A colour means the same everywhere: one per robot, method and perception, colour-blind safe.
"""

PERCEPTION_NAMES = {
    "gauss-markov": "Gauss-Markov error",
    "filter": "filters",
    "fitted": "fitted error",
}

# Okabe and Ito's palette for robots; Tol's "muted" and "bright" for perceptions and methods, none of them shared.
ROBOT_COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#000000")
PERCEPTION_COLOURS = {"gauss-markov": "#CC6677", "filter": "#117733", "fitted": "#88CCEE"}


def rgb(colour: str) -> tuple[float, float, float]:
    """Returns red, green and blue, each from 0 to 1, of a colour such as `#0072B2`."""
    red, green, blue = (int(colour[start : start + 2], 16) / 255.0 for start in (1, 3, 5))
    return red, green, blue
