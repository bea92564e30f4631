"""Markdown tables that line up in plain text too."""

from collections.abc import Sequence
from dataclasses import dataclass

from dynabot_mj.common.intervals import Difference, Hazard, Mean, MeanInterval, Median, Rate


@dataclass(frozen=True, kw_only=True)
class Table:
    """A table for readers."""

    title: str
    header: Sequence[str]
    body: Sequence[Sequence[str]]
    note: str = ""  # what explains it, in paragraphs

    def markdown(self, level: int = 2) -> str:
        """Returns it as Markdown without a line break at the end.

        Args:
            level: Of its heading.
        """
        text = "\n".join([f"{'#' * level} {self.title}", "", *aligned(self.header, self.body)])
        return f"{text}\n\n{self.note}" if self.note else text


def aligned(header: Sequence[str], body: Sequence[Sequence[str]]) -> list[str]:
    """Returns the lines of a Markdown table whose columns line up."""
    widths = [max(len(cell) for cell in column) for column in zip(header, *body, strict=True)]

    def line(cells: Sequence[str]) -> str:
        return "| " + " | ".join(cell.ljust(width) for cell, width in zip(cells, widths, strict=True)) + " |"

    return [line(header), "|" + "|".join("-" * (width + 2) for width in widths) + "|", *map(line, body)]


def mean_and_sd(value: Mean, scale: float = 1.0, digits: int = 1) -> str:
    """Returns a mean, times a scale, as `mean ± sd`, or a dash."""
    if value.mean is None:
        return "-"
    spread = f" ± {scale * value.sd:.{digits}f}" if value.sd is not None else ""
    return f"{scale * value.mean:.{digits}f}{spread}"


def interval(value: MeanInterval | Hazard, digits: int = 1) -> str:
    """Returns a mean, or a hazard, and its interval, or a dash."""
    middle = value.mean if isinstance(value, MeanInterval) else value.rate
    if middle is None:
        return "-"
    text = f"{middle:.{digits}f}"
    return (
        text if value.low is None or value.high is None else f"{text} [{value.low:.{digits}f}, {value.high:.{digits}f}]"
    )


def difference(value: Difference, digits: int) -> str:
    """Returns a difference and its interval, or a dash."""
    return interval(MeanInterval(mean=value.difference, low=value.low, high=value.high), digits)


def median(value: Median, digits: int = 1, sign: str = "") -> str:
    """Returns a median and its interval, open where a number is not known, or a dash.

    Args:
        value: The median.
        digits: Behind the point.
        sign: `+` shows the sign of positive numbers too.
    """
    if value.median is None and value.low is None and value.high is None:
        return "-"
    middle, low, high = (
        "..." if one is None else f"{one:{sign}.{digits}f}" for one in (value.median, value.low, value.high)
    )
    return f"{middle} [{low}, {high}]"


def rate(value: Rate) -> str:
    """Returns a rate and its interval in per cent, or a dash."""
    if value.rate is None or value.low is None or value.high is None:
        return "-"
    return f"{100 * value.rate:.0f} [{100 * value.low:.0f}, {100 * value.high:.0f}]"
