"""Force courses that local laws are tuned and judged on: what a robot may be asked for, one robot at a time.

Each is a force of the field over time, to which the dissipation -c v of the robot's own motion is added as in the
formation, and a particle under the same forces is what the robot should imitate:

step            a constant force, reversed half-way
chirp           a force along one line, its frequency rising from zero
circle          a force of constant size that turns
figure-eight    a turning force whose sense of turning alternates
well            the leader's potential, from some way off, and that of a robot which has arrived there before
noise           a constant force and white noise, one value per control period
"""

import json
import math
import tomllib
from dataclasses import asdict, replace
from pathlib import Path
from typing import Annotated, Literal, get_args

import numpy as np
from pydantic import ConfigDict, Field, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass

from dynabot_mj.common.arrays import Array
from dynabot_mj.common.exceptions import InputError, one_line
from dynabot_mj.controllers.potential_field import Well, attraction

Kind = Literal["step", "chirp", "circle", "figure-eight", "well", "noise"]
KINDS: tuple[Kind, ...] = get_args(Kind)

Positive = Annotated[float, Field(gt=0.0, le=1000.0)]
Finite = Annotated[float, Field(allow_inf_nan=False)]


_NEIGHBOUR_DISTANCE = 3.3  # of a robot that has arrived from the well's centre [m]
_NEIGHBOUR_SHARE = 300.0 / 650.0  # alpha_d / alpha_h of Table III

# More of what a formation is made of.
_ORDER: tuple[Kind, ...] = ("well", "step", "well", "circle", "well", "chirp", "well", "figure-eight", "well", "noise")


@dataclass(frozen=True, kw_only=True, config=ConfigDict(extra="forbid", strict=True))
class Manoeuvre:
    """One course."""

    kind: Kind
    force: Annotated[float, Field(ge=0.0, le=1000.0)] = 25.0  # its size [N]
    direction: Finite = 0.0  # of the force at the start, from the robot's heading [rad]
    frequency: Positive = 0.2  # of chirp (at its end), circle and figure-eight [Hz]
    gain: Positive = 650.0  # alpha_h of the well [N m]
    distance: Positive = 9.0  # of the start from the well's centre [m]
    neighbour: Finite = 1.0  # bearing of the robot in the well, seen from its centre, from that of the start [rad]
    seed: Annotated[int, Field(ge=0)] = 0  # of the noise


@dataclass(frozen=True, kw_only=True, config=ConfigDict(arbitrary_types_allowed=True))
class Courses:
    """Manoeuvres of one length, sampled at the control period; the robots' headings are zero at their start."""

    force_w: Array  # (S, K, 2) beside the wells' [N]
    gain: Array  # (S,) alpha_h of the wells, 0 where there is none [N m]
    neighbour_gain: Array  # (S,) alpha_d of the robots that stand there [N m]
    neighbour_w: Array  # (S, 2) their places, from the wells' centres [m]
    start_w: Array  # (S, 2) from the well's centre [m]
    period: float  # [s]


def sampled(manoeuvres: list[Manoeuvre], duration: float, period: float) -> Courses:
    """Samples manoeuvres at the beginning of each control period.

    Args:
        manoeuvres: S of them.
        duration: Of each, rounded up to whole periods [s].
        period: T_c [s].
    """
    time: Array = period * np.arange(math.ceil(duration / period - 1e-9), dtype=np.float64)
    wells = np.array([one.kind == "well" for one in manoeuvres])
    # The well lies in the manoeuvre's direction from the start.
    start = np.array([-one.distance * _unit(one.direction) for one in manoeuvres])
    beside = np.array([-_NEIGHBOUR_DISTANCE * _unit(one.direction + one.neighbour) for one in manoeuvres])
    gain = np.where(wells, [one.gain for one in manoeuvres], 0.0)
    return Courses(
        force_w=np.stack([_force(one, time, float(time[-1] + period)) for one in manoeuvres]),
        gain=gain,
        neighbour_gain=_NEIGHBOUR_SHARE * gain,
        neighbour_w=beside,
        start_w=np.where(wells[:, None], start, 0.0),
        period=period,
    )


def random(seed: int, count: int, purpose: int) -> list[Manoeuvre]:
    """Returns manoeuvres of all kinds, of random size and direction; half of them are wells.

    Args:
        seed: Of the random numbers.
        count: How many.
        purpose: Different sets for different purposes, e.g. tuning and validation.
    """
    generator = np.random.default_rng([seed, purpose])
    return [_drawn(_ORDER[index % len(_ORDER)], generator) for index in range(count)]


def of_each_kind(seed: int, count: int, purpose: int) -> list[Manoeuvre]:
    """Returns `count` manoeuvres of the first kind, then as many of the next; see `random`."""
    generator = np.random.default_rng([seed, purpose])
    return [_drawn(kind, generator) for kind in KINDS for _ in range(count)]


def load(path: Path) -> list[Manoeuvre]:
    """Reads manoeuvres from a TOML file with one table `[[manoeuvre]]` for each.

    Raises:
        InputError: If the file cannot be read, or a key or a value is not allowed.
    """
    try:
        tree = tomllib.loads(path.read_text(encoding="utf-8"))
        tables = tree.get("manoeuvre")
        tables_only = isinstance(tables, list) and all(isinstance(one, dict) for one in tables)
        if len(tree) != 1 or not tables or not tables_only:
            raise InputError(f"{path}: it must have tables [[manoeuvre]], and nothing else")
        # From JSON, since strict validation refuses plain dicts for dataclasses.
        return [TypeAdapter(Manoeuvre).validate_json(json.dumps(one, default=str)) for one in tables]
    except ValidationError as error:
        allowed = ", ".join(asdict(Manoeuvre(kind="step")))
        raise InputError(f"{path}: {one_line(error)} (the keys are {allowed})") from error
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(f"cannot read the manoeuvres {path}: {error}") from error


def field_force(position_w: Array, courses: Courses, radius: float, width: float, spacing: float) -> Array:
    """Returns the force of each course's well and of the robot that stands there, (S, 2) [N].

    Args:
        position_w: From the wells' centres, (S, 2) [m].
        courses: The courses.
        radius: h0 [m].
        width: epsilon [m].
        spacing: d0 [m].
    """
    leader = Well(gain=1.0, radius=radius, width=width, range=math.inf)
    neighbour = replace(leader, radius=spacing)
    of_leader = courses.gain[:, None] * attraction(position_w, leader)
    return of_leader + courses.neighbour_gain[:, None] * attraction(position_w - courses.neighbour_w, neighbour)


def _drawn(kind: Kind, generator: np.random.Generator) -> Manoeuvre:
    return Manoeuvre(
        kind=kind,
        force=float(generator.uniform(5.0, 15.0) if kind == "noise" else generator.uniform(10.0, 45.0)),
        direction=float(generator.uniform(-math.pi, math.pi)),
        frequency=float(generator.uniform(0.1, 0.4)),
        gain=float(generator.uniform(300.0, 650.0)),
        distance=float(generator.uniform(7.0, 11.0)),
        neighbour=float(generator.uniform(-1.5, 1.5)),
        seed=int(generator.integers(2**31)),
    )


def _unit(angle: float) -> Array:
    return np.array([math.cos(angle), math.sin(angle)])


def _force(one: Manoeuvre, time: Array, duration: float) -> Array:
    """Returns the force beside the well's, (K, 2) [N]."""
    phase = 2.0 * np.pi * one.frequency * time
    size = np.full_like(time, one.force)
    angle = np.full_like(time, one.direction)
    match one.kind:
        case "step":
            size = np.where(time < duration / 2.0, one.force, -one.force)
        case "chirp":
            size = one.force * np.cos(0.5 * phase * time / duration)
        case "circle":
            angle = one.direction + phase
        case "figure-eight":
            angle = one.direction + 2.4 * np.sin(phase)
        case "well":
            size = np.zeros_like(time)
        case "noise":
            noise = one.force * np.random.default_rng(one.seed).standard_normal((len(time), 2))
            return noise + 15.0 * _unit(one.direction)
    return size[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
