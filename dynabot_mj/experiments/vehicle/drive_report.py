"""The acceptance drive as a table with its bands, as a JSON document, and repeated over step sizes."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from dynabot_mj.common import tables
from dynabot_mj.experiments.vehicle import drive
from dynabot_mj.experiments.vehicle.drive import DriveReport
from dynabot_mj.experiments.vehicle.drive_figures import Corner, Figures
from dynabot_mj.plants import scene
from dynabot_mj.plants.scene import Conditions

HEAVIEST_PAYLOAD = 100.0  # eight times the robot's own mass; beyond, it is another vehicle [kg]
STEP_SIZES = (0.0005, 0.001, 0.002, 0.004, 0.005, 0.006, 0.008)  # [s]
ALIKE_UP_TO = 0.005  # longest step that has to give the same figures [s]
ALIKE = 0.01  # (max - min) / mean of figures that are the same


@dataclass(frozen=True, kw_only=True)
class Line:
    """One line of the table."""

    name: str
    value: float | None
    unit: str
    low: float | None = None  # acceptance band; None: no bound
    high: float | None = None
    compared: bool = True  # over step sizes; not what is zero, counted or chosen from a list

    @property
    def judged(self) -> bool:
        """Whether there is a band."""
        return self.low is not None or self.high is not None

    @property
    def holds(self) -> bool:
        """Whether the value is within the band."""
        if self.value is None:
            return False
        return (self.low is None or self.value >= self.low) and (self.high is None or self.value <= self.high)


def lines(figures: Figures) -> list[Line]:
    """Returns what is shown and compared, the corners apart, with the acceptance bands of the robot as it is."""
    one = figures
    return [
        Line(name="top speed", value=one.top_speed_mps, unit="m/s", low=10.0, high=10.6),
        Line(name="time to 95 % of it", value=one.time_to_95_percent_s, unit="s"),
        Line(name="peak acceleration", value=one.peak_acceleration_g, unit="g", low=0.48, high=0.55),
        Line(name="mean acceleration to 95 %", value=one.mean_acceleration_g, unit="g"),
        Line(name="drift, driving straight", value=one.drift_mm_per_m, unit="mm/m", high=0.01, compared=False),
        Line(name="braking from 5 m/s: distance", value=one.braking_distance_m, unit="m"),
        Line(name="braking from 5 m/s: time", value=one.braking_time_s, unit="s"),
        Line(name="peak deceleration", value=one.peak_deceleration_g, unit="g"),
        Line(name="coasting from 5 to 2.5 m/s: distance", value=one.coasting_distance_m, unit="m"),
        Line(name="coasting from 5 to 2.5 m/s: time", value=one.coasting_time_s, unit="s"),
        Line(name="rolling radius", value=one.rolling_radius_m, unit="m"),
        *(
            Line(name=f"turn rate / theory at ±{speed} rad/s", value=ratio, unit="", low=0.95, high=1.08)
            for speed, ratio in one.turn_rate_over_theory.items()
        ),
        Line(name="heading spread", value=100.0 * one.heading_spread, unit="%", high=1.0, compared=False),
        Line(name="airborne", value=100.0 * one.airborne_fraction, unit="% of steps", high=0.0, compared=False),
        Line(
            name="airborne, not spun out",
            value=100.0 * one.airborne_fraction_gripping,
            unit="% of steps",
            high=0.0,
            compared=False,
        ),
        Line(name="free slides: steps gaining energy", value=one.energy_gain_steps, unit="", high=0.0, compared=False),
        *_slopes(one),
        Line(name="motor current, launch", value=one.launch_current_a, unit="A"),
        Line(name="motor current, top speed", value=one.top_speed_current_a, unit="A"),
        Line(name="motor voltage, launch", value=one.launch_voltage_v, unit="V"),
        Line(name="motor voltage, top speed", value=one.top_speed_voltage_v, unit="V"),
        *_collision(one),
        Line(name="MuJoCo warnings", value=one.warnings, unit="", high=0.0, compared=False),
    ]


def document(report: DriveReport) -> dict[str, Any]:
    """Returns the JSON document of `dynabot drive`."""
    given = {"model": report.conditions.model, "payload_kg": report.conditions.payload}
    bands = {one.name: one.holds for one in lines(report.figures) if one.judged}
    return {**given, **asdict(report.figures), **({"acceptance": bands} if _is_nominal(report) else {})}


def markdown(report: DriveReport) -> str:
    """Returns the result as readable tables; the bands are those of the robot as it is, so only it is judged."""
    figures = report.figures
    judge = _is_nominal(report)
    body = [
        [one.name, _number(one.value), one.unit, *([_band(one), _verdict(one)] if judge else [])]
        for one in lines(figures)
    ]
    header = ["figure", "value", "unit", *(["band", "holds"] if judge else [])]
    return "\n".join(
        [
            f"# Acceptance drive: {report.conditions.model}, {figures.mass_kg:g} kg, friction {figures.friction:g}, "
            f"step {figures.timestep_ms:g} ms",
            "",
            *tables.aligned(header, body),
            "",
            "Peaks are means over 20 ms. Corners without yaw feedback: radius [m] (largest side slip [deg]) by forward",
            "speed and difference of the right and the left wheels' commands. Spun out: side slip beyond 45 deg.",
            "",
            *_corners(figures.cornering),
            "",
        ]
    )


def step_sizes(conditions: Conditions = scene.NOMINAL, sizes: tuple[float, ...] = STEP_SIZES) -> dict[float, Figures]:
    """Repeats the drive for each physics step [s]."""
    return {size: drive.drive(conditions, size).figures for size in sizes}


def spreads(found: Mapping[float, Figures]) -> dict[str, float]:
    """Returns (max - min) / mean of each compared figure over the steps that have to give the same."""
    alike = [lines(figures) for size, figures in found.items() if size <= ALIKE_UP_TO]
    spread = {}
    for versions in zip(*alike, strict=True):
        values = [one.value for one in versions if one.value is not None]
        if versions[0].compared and values:
            spread[versions[0].name] = (max(values) - min(values)) * len(values) / max(abs(sum(values)), 1e-12)
    return spread


def step_document(found: Mapping[float, Figures]) -> dict[str, Any]:
    """Returns the same as a JSON document."""
    return {"rows": [asdict(figures) for figures in found.values()], "spread": spreads(found)}


def step_table(found: Mapping[float, Figures]) -> str:
    """Returns the drive's figures by physics step as a table."""
    spread = spreads(found)
    body = []
    for versions in zip(*(lines(figures) for figures in found.values()), strict=True):
        one = versions[0]
        difference = spread.get(one.name)
        verdict = ["", ""] if difference is None else [f"{100.0 * difference:.2f}", _yes(difference < ALIKE)]
        body.append([one.name, one.unit, *(_number(version.value) for version in versions), *verdict])
    up_to = f"{1e3 * ALIKE_UP_TO:g} ms"
    header = ["figure", "unit", *(f"{1e3 * size:g} ms" for size in found), f"spread to {up_to} [%]", "under 1 %"]
    return "\n".join(tables.aligned(header, body)) + "\n"


def _is_nominal(report: DriveReport) -> bool:
    return report.conditions == scene.NOMINAL


def _slopes(one: Figures) -> list[Line]:
    creep = [
        Line(name=f"creep{where}, slope {slope}", value=value, unit="mm/s")
        for where, found in ((" uphill", one.slope_creep_mmps), (" across", one.slope_creep_across_mmps))
        for slope, value in found.items()
    ]
    return [
        *creep,
        Line(name="largest slope held within 1 mm/s", value=one.largest_slope_held, unit="m/m", compared=False),
        Line(name="largest slope of steady creep", value=one.largest_slope_braked, unit="m/m", compared=False),
    ]


def _collision(one: Figures) -> list[Line]:
    crash = one.collision
    return [
        Line(name="collision: closing speed", value=crash.closing_speed_mps, unit="m/s"),
        # An extreme over the phases of the step, so it depends on the step; it is bounded instead.
        Line(name="collision: hull overlap", value=100.0 * crash.overlap_m, unit="cm", high=2.0, compared=False),
        Line(name="collision: rise of a chassis", value=100.0 * crash.rise_m, unit="cm", high=1.0, compared=False),
        Line(name="collision: momentum error", value=100.0 * crash.momentum_error, unit="%", high=1.0, compared=False),
    ]


def _corners(corners: tuple[Corner, ...]) -> list[str]:
    speeds = sorted({corner.speed_mps for corner in corners})
    differences = sorted({corner.wheel_difference_radps for corner in corners})
    cells = {(corner.speed_mps, corner.wheel_difference_radps): _cell(corner) for corner in corners}
    body = [[f"{speed:g} m/s", *(cells[speed, difference] for difference in differences)] for speed in speeds]
    return tables.aligned(["forward", *(f"{difference:g} rad/s" for difference in differences)], body)


def _cell(corner: Corner) -> str:
    slip = f"({corner.side_slip_deg:.1f})"
    return f"spun out {slip}" if corner.radius_m is None else f"{corner.radius_m:.2f} {slip}"


def _number(value: float | None) -> str:
    if value is None:
        return "-"
    return str(value) if isinstance(value, int) else f"{value:.4g}"


def _band(one: Line) -> str:
    match one.low, one.high:
        case None, None:
            return ""
        case None, high:
            return f"at most {high:g}"
        case low, None:
            return f"at least {low:g}"
        case low, high:
            return f"{low:g} to {high:g}"


def _verdict(one: Line) -> str:
    return _yes(one.holds) if one.judged else ""


def _yes(fact: bool) -> str:
    return "yes" if fact else "NO"
