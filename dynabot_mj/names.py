"""What readers of figures, films and reports call methods, perceptions and plants."""

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


def method(estimator: str, perception: str | None = None) -> str:
    """Returns a method's name with that of its perception, where one is given."""
    return f"{METHOD_NAMES[estimator]}, {PERCEPTION_NAMES[perception]}" if perception else METHOD_NAMES[estimator]
