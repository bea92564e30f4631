"""The kinds of robots, one record each: what they are called, how they are drawn, and whether they are bodies.

To add one, write the methods of `plant.Plant` (and of `plant.WheeledPlant`, if it has wheels), its name and its record
here, and how a configuration makes it in `dynabot_mj.study.fleet.plant`.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal, get_args

PlantName = Literal["particle", "rigid"]
PLANTS: tuple[PlantName, ...] = get_args(PlantName)
COMPARED: tuple[PlantName, ...] = ("particle", "rigid")  # by studies, unless told otherwise


@dataclass(frozen=True, kw_only=True)
class PlantRecord:
    """A kind of robots."""

    label: str  # in figures, films and reports
    body: bool  # extends and stands on the ground of `[vehicle]`: hulls, not centres, collide
    line: str | tuple[float, tuple[float, ...]]  # style of its lines, as Matplotlib takes it
    opacity: float  # of its bars
    work: tuple[float, float]  # rough seconds for a second of a trial: of the trial, and of each robot
    chunk: int  # trials that are run at once: many, where that is cheaper


KINDS: Mapping[str, PlantRecord] = {
    "particle": PlantRecord(
        label="point masses", body=False, line=(0, (3.0, 1.4)), opacity=0.45, work=(2e-4, 0.0), chunk=200
    ),
    "rigid": PlantRecord(label="rigid bodies", body=True, line="-", opacity=1.0, work=(0.0, 1.5e-3), chunk=50),
}


def any_bodies(names: Iterable[str]) -> bool:
    """Tells whether there are bodies among some kinds."""
    return any(KINDS[name].body for name in names)
