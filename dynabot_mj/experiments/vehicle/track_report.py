"""How what `track` found is told: its JSON document and its tables."""

from dataclasses import asdict
from typing import Any

from dynabot_mj.common import tables
from dynabot_mj.experiments.vehicle import manoeuvres
from dynabot_mj.experiments.vehicle.track import (
    COURSE_DURATION,
    COURSE_PERIOD,
    COURSES_PER_KIND,
    LAWS,
    FormationRow,
    TrackReport,
)

_FORMATION_HEADER = ["formation [s]", "particles [s]", "later by [s]"]
_COMMON_HEADER = ["velocity RMS [m/s]", "position RMS [m]", "yaw path [rad]", "slip [m/s]"]


def document(report: TrackReport) -> dict[str, Any]:
    """Returns the JSON document."""
    return {
        "seed": report.seed,
        "courses": [asdict(one) for one in report.courses],
        "formations": [asdict(one) for one in report.formations],
        "frictions": [asdict(one) for one in report.frictions],
    }


def markdown(report: TrackReport) -> str:
    """Returns the report as tables."""
    kinds = list(manoeuvres.KINDS)
    courses = [
        [laws.label]
        + [f"{one.velocity_rms_mps:.3f}, {one.position_rms_m:.2f}" for one in report.courses if one.laws == laws.label]
        for laws in LAWS
    ]
    first = report.formations[0]
    lines = [
        f"# Tracking of particles by vehicles, seed {report.seed}",
        "",
        f"Velocity RMS [m/s], position RMS [m] over {COURSES_PER_KIND} courses of {COURSE_DURATION:g} s of each kind, "
        f"T_c = {1e3 * COURSE_PERIOD:g} ms:",
        "",
        *tables.aligned(["law, gains", *kinds], courses),
        "",
        f"Formation with perfect information, {first.trials} trials, against the same trials of particles:",
        "",
        *tables.aligned(
            ["law, gains", "T_c [ms]", *_FORMATION_HEADER, *_COMMON_HEADER],
            [[one.laws, f"{one.period_ms:g}", *_formed(one), *_common(one)] for one in report.formations],
        ),
        "",
        f"The same over friction, {report.frictions[0].laws}, T_c = {1e3 * COURSE_PERIOD:g} ms:",
        "",
        *tables.aligned(
            ["friction", *_FORMATION_HEADER, "hulls", "band 1 m", *_COMMON_HEADER],
            [
                [
                    f"{one.friction:g}",
                    *_formed(one),
                    *map(tables.rate, (one.collision_footprint, one.completion_common)),
                    *_common(one),
                ]
                for one in report.frictions
            ],
        ),
        "",
        "Formation: when the common band began to hold for 5 s, as a mean restricted to the duration, which counts",
        "for trials that did not form or touched before; later by: the mean difference on the same trials; both with",
        "95 % BCa intervals. Rates in % with 95 % Wilson intervals. Velocity and position RMS are over robots, trials",
        "and the whole run. Yaw path (in the last 10 s) and slip are the largest of any robot in any trial.",
    ]
    return "\n".join(lines) + "\n"


def _formed(row: FormationRow) -> list[str]:
    later = tables.difference(row.formation_delay_s, 2)
    return [tables.interval(row.formation_s), tables.interval(row.particle_formation_s), later]


def _common(row: FormationRow) -> list[str]:
    return [
        f"{row.velocity_rms_mps:.3f}",
        f"{row.position_rms_m:.2f}",
        f"{row.largest_yaw_path_rad:.2f}",
        f"{row.largest_slip_mps:.2f}",
    ]
