"""A study over a grid: one configuration, some keys of which take several values; what differs names the cases.

A campaign of one point is a study as `compare` runs it. Nothing here knows what a trial is: `dataset` makes chunks of
the cases, `execution` does them.
"""

import functools
import itertools
import json
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomli_w

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.common.trees import flat
from dynabot_mj.study import configuration, scenario
from dynabot_mj.study.scenario import Case, Scenario

_ZIP = "zip"
_REFUSED = {
    **dict.fromkeys(
        ("plants", "estimators", "perception"), "a study has several of them without a grid: {key} = [...]"
    ),
    **dict.fromkeys(
        ("trials", "first_trial"), "all points have the same trials, so that they can be compared in pairs"
    ),
    "seed": "all points have the same random numbers; for independent repetitions give more trials",
}
_MOST = 10_000  # points
_NONE: Mapping[str, Any] = {}


@dataclass(frozen=True)
class Point:
    """One configuration of a campaign."""

    setup: Scenario
    values: Mapping[str, Any]  # of the grid's keys, by their dotted names


@dataclass(frozen=True)
class Entry:
    """A case of one point: what one row of the result is about."""

    point: int
    case: Case
    label: str  # e.g. `particle/gauss-markov/gps/robots=5`


@dataclass(frozen=True)
class Campaign:
    """Configurations that differ in the keys of a grid."""

    points: tuple[Point, ...]
    grid: str = ""  # as TOML; "": there is none

    @property
    def first(self) -> Scenario:
        """The first point's configuration, for what all of them share."""
        return self.points[0].setup

    @property
    def text(self) -> str:
        """The campaign as TOML, which `parse` reads."""
        return f"{configuration.dump(self.first)}\n{self.grid}" if self.grid else configuration.dump(self.first)

    @property
    def grid_values(self) -> dict[str, Any]:
        """The grid as plain values, for what results depend on."""
        return tomllib.loads(self.grid)

    @functools.cached_property
    def names(self) -> dict[str, str]:
        """What the grid's keys are called in labels and coordinates: without their tables where that is clear."""
        keys = list(self.points[0].values)
        short = Counter(key.rpartition(".")[2] for key in keys)
        return {key: last if short[last := key.rpartition(".")[2]] == 1 and last not in _TAKEN else key for key in keys}

    @functools.cached_property
    def entries(self) -> tuple[Entry, ...]:
        """All cases, those of one point together."""
        return tuple(
            Entry(index, case, "/".join([case.label, *self._told(point)]))
            for index, point in enumerate(self.points)
            for case in scenario.cases(point.setup)
        )

    def _told(self, point: Point) -> Iterator[str]:
        for key, value in point.values.items():
            text = value if isinstance(value, str) else json.dumps(value)
            yield f"{self.names[key]}={Path(text).stem if '/' in text else text}".replace(" ", "")


# Variables and coordinates of the Dataset that a short name must not hide.
_TAKEN = {
    *(
        "case",
        "plant",
        "perception",
        "estimator",
        "velocity",
        "trial",
        "time",
        "axis",
        "robot",
        "lag",
        "recorded",
        "point",
    ),
    *("alpha_h", "alpha_d", "sample_period", "control_period"),
}


def single(setup: Scenario) -> Campaign:
    """Returns the campaign of one configuration."""
    return Campaign((Point(setup, {}),))


def load_file(path: Path, **options: Any) -> Campaign:
    """Reads a configuration file with a `[grid]`, or without one; see `load`."""
    return load(configuration.read(path), str(path), **options)


def parse(text: str, origin: str) -> Campaign:
    """Reads the text of a campaign; see `load`."""
    return load(configuration.parsed(text, origin), origin)


def load(tree: Mapping[str, Any], origin: str, typed: Mapping[str, str] = _NONE, **options: Any) -> Campaign:
    """Builds a campaign.

    Args:
        tree: A configuration, and `grid`: lists by dotted key, crossed; those of `grid.zip`, as long as each other, go
            together.
        origin: Where it comes from, for the messages.
        typed: What the user typed to set a key, see `configuration.build`.
        **options: That override keys, see `configuration.build`.

    Raises:
        InputError: If the grid is none, or one of its points is no configuration.
    """
    try:
        return _load(tree, origin, typed, **options)
    except RecursionError:
        raise InputError(f"{origin} is no configuration: tables are nested too deeply") from None


def _load(tree: Mapping[str, Any], origin: str, typed: Mapping[str, str], **options: Any) -> Campaign:
    rest = dict(tree)
    grid = rest.pop("grid", {})
    if not isinstance(grid, Mapping):
        raise InputError(
            f"{origin}: grid = {grid!r} given, it must be a table of lists, such as [grid] robots = [3, 5]"
        )
    points = []
    for values in _points(grid, origin):
        told = ", ".join(f"{key} = {value}" for key, value in values.items())
        try:
            setup = configuration.build(_with(rest, values, origin), origin, typed, **options)
        except InputError as error:
            if not values:
                raise
            raise type(error)(f"{error} (at {told} of the grid)") from error
        points.append(Point(setup, values))
    if clash := sorted({key for point in points for key in point.values} & {*_given(options)}):
        raise InputError(f"{clash[0]} given by an option and by the grid of {origin}; give it once")
    made = Campaign(tuple(points), tomli_w.dumps({"grid": grid}) if grid else "")
    labels = Counter(entry.label for entry in made.entries)
    if twice := [label for label, count in labels.items() if count > 1]:
        raise InputError(f"{origin}: the grid has {twice[0]} twice")
    return made


def _given(options: Mapping[str, Any]) -> Iterator[str]:
    for key, value in options.items():
        if value is not None:
            table = configuration.TABLES.get(key)
            yield f"{table}.{key}" if table else key


def _points(grid: Mapping[str, Any], origin: str) -> Iterator[dict[str, Any]]:
    """Yields the values of each point."""
    crossed = dict(flat({key: value for key, value in grid.items() if key != _ZIP}))
    zipped = grid.get(_ZIP, {})
    if not isinstance(zipped, Mapping):
        raise InputError(f"{origin}: grid.zip = {zipped!r} given, it must be a table of lists")
    zipped = dict(flat(zipped))
    for key, values in [*crossed.items(), *zipped.items()]:
        if not isinstance(values, list) or not values:
            raise InputError(f"{origin}: grid.{key} = {values!r} given, it must be a list of values")
        if why := _REFUSED.get(key):
            raise InputError(f"{origin}: grid.{key} given, but {why.format(key=key)}")
        if key in crossed and key in zipped:
            raise InputError(f"{origin}: grid.{key} given, and grid.zip.{key} too")
        if len({json.dumps(one, default=str) for one in values}) < len(values) and key in crossed:
            raise InputError(f"{origin}: grid.{key} = {values!r} given, it has a value twice")
    lengths = {key: len(values) for key, values in zipped.items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{key} has {length}" for key, length in lengths.items())
        raise InputError(f"{origin}: the lists of grid.zip must have one length, but {told}")
    together = [dict(zip(zipped, row, strict=True)) for row in zip(*zipped.values(), strict=True)] if zipped else [{}]
    count = len(together)
    for values in crossed.values():
        count *= len(values)
    if count > _MOST:
        raise InputError(f"{origin}: the grid has {count} points, at most are allowed {_MOST}")
    for row in itertools.product(*crossed.values()):
        for beside in together:
            yield {**dict(zip(crossed, row, strict=True)), **beside}


def _with(tree: Mapping[str, Any], values: Mapping[str, Any], origin: str) -> dict[str, Any]:
    """Returns a tree with some values set, by dotted key."""
    found = dict(tree)  # tables are copied where they are changed
    for key, value in values.items():
        *tables, last = key.split(".")
        place = found
        for table in tables:
            inner = place.get(table, {})
            if not isinstance(inner, Mapping):
                raise InputError(f"{origin}: grid.{key} given, but {table} is no table")
            place[table] = dict(inner)
            place = place[table]
        place[last] = value
    return found
