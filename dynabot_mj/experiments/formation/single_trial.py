"""One trial of one case, told as what happened in it: there are no rates and no intervals of one."""

import math

import xarray as xr

from dynabot_mj.common import tables
from dynabot_mj.experiments.formation import trial_values
from dynabot_mj.experiments.formation.compare_tables import title


def markdown(case: xr.Dataset) -> str:
    """Returns what happened in the first trial of a case of a study's Dataset."""
    known = case.diverged.values[0] == 0
    body = [
        ["arrival", _time(case, "arrival", "not arrived")],
        ["time to formation", _time(case, "formation", "not formed")],
        ["time in the band since arrival", _share(case, "in_band")],
        ["first contact of hulls", _time(case, "contact", "none")],
        ["overturned", _time(case, "overturned", "no")],
        ["formation within 1 m, without contact, in the last 10 s", _yes(case, "completion_common")],
        ["top speed", _number(case, "top_speed", "m/s")],
        ["smallest distance of two centres", _number(case, "closest", "m")],
        ["mean age of the positions acted on", _number(case, "message_age", "s")],
        ["the paper's settling time", _time(case, "settling", "not settled, or centres collided")],
        ["the paper's completion, within the method's own sigma", _yes(case, "completion")],
    ]
    heading = f"# {case.case.item()}, trial {case.trial.values[0]}: {title(case)}"
    told = tables.aligned(["measure", "value"], body) if known else ["The trial diverged: its simulation broke down."]
    periods = f"T_s = {1e3 * case.sample_period.item():g} ms, T_c = {1e3 * case.control_period.item():g} ms"
    gains = f"gains {case.alpha_h.item():g}, {case.alpha_d.item():g}"
    return "\n".join(
        [heading, "", f"{periods}; {gains}; velocity of the dissipation: {case.velocity.item()}", "", *told, ""]
    )


def _time(case: xr.Dataset, name: str, otherwise: str) -> str:
    value = float(trial_values.variable(case, name)[0])
    return otherwise if math.isnan(value) else f"{value:.2f} s"


def _number(case: xr.Dataset, name: str, unit: str) -> str:
    value = float(trial_values.variable(case, name)[0])
    return "-" if math.isnan(value) else f"{value:.3g} {unit}"


def _share(case: xr.Dataset, name: str) -> str:
    value = float(trial_values.variable(case, name)[0])
    return "-" if math.isnan(value) else f"{100.0 * value:.0f} %"


def _yes(case: xr.Dataset, name: str) -> str:
    value = float(trial_values.variable(case, name)[0])
    return "-" if math.isnan(value) else ("yes" if value == 1.0 else "no")
