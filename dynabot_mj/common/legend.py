"""What methods, perceptions and plants are called in figures, films and reports, and their colours.

A colour means the same everywhere: one per robot and one per method, colour-blind safe.
"""

METHOD_NAMES = {
    "perfect": "perfect information",
    "gps": "GPS",
    "decoupled": "decoupled EKF",
    "coupled": "coupled EKF",
}
PERCEPTION_NAMES = {
    "gauss-markov": "Gauss-Markov error",
    "filter": "filters",
    "fitted": "fitted error",
}
PLANT_NAMES = {"particle": "point masses", "rigid": "rigid bodies"}

# Okabe and Ito's palette for robots; Tol's "muted" and "bright" for methods and perceptions, none of them shared.
ROBOT_COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#000000")
METHOD_COLOURS = {"perfect": "#777777", "gps": "#AA3377", "decoupled": "#332288", "coupled": "#999933"}
PERCEPTION_COLOURS = {"gauss-markov": "#CC6677", "filter": "#117733", "fitted": "#88CCEE"}


def method(estimator: str, perception: str | None = None) -> str:
    """Returns a method's name with that of its perception, where one is given."""
    return f"{METHOD_NAMES[estimator]}, {PERCEPTION_NAMES[perception]}" if perception else METHOD_NAMES[estimator]


def rgb(colour: str) -> tuple[float, float, float]:
    """Returns red, green and blue, each from 0 to 1, of a colour such as `#0072B2`."""
    red, green, blue = (int(colour[start : start + 2], 16) / 255.0 for start in (1, 3, 5))
    return red, green, blue
