"""A plan of trials as JSON and as tables."""

import textwrap
from dataclasses import asdict
from typing import Any

from dynabot_mj.common import tables
from dynabot_mj.common.tables import Table
from dynabot_mj.experiments.formation import power_laws
from dynabot_mj.experiments.formation.power import Need, Origin, Plan, Variances

_NOTE = (
    "Ratio: Var(a) + Var(b) over Var(a - b), how many times as many trials are needed where they are different ones; "
    "below 1, common random numbers cost. All pairs of cases that differ in one factor, as the pilot has them."
)
_ORIGINS: dict[Origin, str] = {
    "given": "as given",
    "pilot": "the pilot's own",
    "low": "its interval's low end",
    "high": "its interval's high end",
}


def document(plan: Plan) -> dict[str, Any]:
    """Returns the JSON document; differences are in SI units, and those of rates shares of 1."""
    return {
        **asdict(plan.request),
        "unit": plan.measure.unit,
        "alpha_each": plan.alpha,
        "test": "mcnemar" if plan.measure.rate else "sign flips",
        "pilot": {
            "trials": plan.pilot_trials,
            **asdict(plan.estimate),
            "discordant": None if plan.discordant is None else asdict(plan.discordant),
        },
        "needs": [asdict(one) for one in plan.needs],
        "unpaired_trials": plan.unpaired_trials,
        "variances": [asdict(one) for one in plan.variances],
        "curve": [asdict(one) for one in plan.curve],
    }


def markdown(plan: Plan) -> str:
    """Returns the tables, as `dynabot power` prints them."""
    return f"{_needs(plan).markdown(level=1)}\n\n{_variances(plan).markdown()}\n"


def title(plan: Plan) -> str:
    """Returns what a plan is of."""
    return f"Trials for {plan.measure.name}, {plan.request.a} - {plan.request.b}"


def target(plan: Plan) -> str:
    """Returns what is asked of the trials."""
    each = f" / {plan.request.comparisons}" if plan.request.comparisons > 1 else ""
    return f"power {plan.request.power:g} at p below {plan.request.alpha:g}{each}"


def answer(plan: Plan, need: Need) -> str:
    """Returns a number of trials, or why there is none."""
    if need.trials is None:
        return "none is enough" if need.difference == 0.0 else f"more than {power_laws.MOST}"
    return str(need.trials)


def signed(plan: Plan, difference: float) -> str:
    """Returns a difference with its sign, without its unit."""
    digits = max(plan.measure.digits, 1)
    return f"{plan.measure.scale * difference:+.{digits}f}"


def _needs(plan: Plan) -> Table:
    measure, header = plan.measure, ["difference", f"a - b [{plan.measure.unit}]"]
    discordant = ["discordant [%]"] if measure.rate else []
    return Table(
        title=title(plan),
        header=[*header, *discordant, "trials", "power there"],
        body=[
            [
                _ORIGINS[one.origin] if one.difference else "0, in its interval",
                signed(plan, one.difference),
                *([f"{100.0 * one.discordant:.1f}"] if one.discordant is not None else []),
                answer(plan, one),
                _power(one),
            ]
            for one in plan.needs
        ],
        note="\n\n".join(textwrap.fill(one, 120) for one in (_what(plan), *_remarks(plan))),
    )


def _what(plan: Plan) -> str:
    """Returns what is promised, by which test, from what."""
    n = plan.estimate.n
    text = f"For {target(plan)}"
    text += " (Holm's first step)" if plan.request.comparisons > 1 else ""
    text += " and the right sign: the test is "
    if plan.measure.rate:
        text += "McNemar's, whose power is exact, and no larger number of trials has less than is asked for."
    else:
        text += (
            f"the permutation test, whose power is of {power_laws.STUDIES} studies drawn from the pilot's differences, "
            "centred and shifted; its 95 % interval is above what is asked for."
        )
    text += f" The pilot has {n} pairs of this measure"
    if n < plan.pilot_trials:
        text += f" in {plan.pilot_trials} trials; as many of the new ones are taken to have no value in both cases"
    return f"{text}."


def _remarks(plan: Plan) -> list[str]:
    """Returns what has to be said of a plan."""
    found = []
    if plan.needs[0].origin == "pilot":
        text = (
            "The difference is the pilot's own, a noisy estimate that tends to be too large where it was chosen for "
            "its size: count on the number at the end of its interval that is nearer to 0, or say with --difference "
            "which one matters."
        )
        if any(one.difference == 0.0 for one in plan.needs):
            text += " The interval includes 0, where no number of trials is enough."
        found.append(text)
    if plan.discordant is not None and plan.discordant.rate is not None:
        text = f"Discordant pairs are {tables.rate(plan.discordant)} % of the pilot's"
        if raised := [signed(plan, one.difference) for one in plan.needs if one.raised]:
            text += (
                f", fewer than a difference of {' or '.join(raised)} has: their share was raised to the difference, "
                "the least that it can be, with all of them of one sign"
            )
        found.append(f"{text}; more of them need more trials.")
    saved, trials = plan.variances[0], plan.needs[0].trials
    if plan.unpaired_trials is not None and saved.ratio is not None:
        found.append(
            f"Without common random numbers, on different trials, about {plan.unpaired_trials} of each case would be "
            f"needed instead of {trials}: Var(a) + Var(b) is {saved.ratio:.2f} times Var(a - b) in the pilot."
        )
    return found


def _variances(plan: Plan) -> Table:
    unit = f"[{plan.measure.unit}²]"
    return Table(
        title=f"What common random numbers save, by {plan.measure.name}",
        header=["a", "b", "n", f"Var(a) {unit}", f"Var(b) {unit}", f"Var(a - b) {unit}", "ratio"],
        body=[_row(plan, one) for one in plan.variances],
        note=textwrap.fill(_NOTE, 120),
    )


def _row(plan: Plan, one: Variances) -> list[str]:
    scale = plan.measure.scale**2
    values = (one.variance_a, one.variance_b, one.variance_difference)
    ratio = "-" if one.ratio is None else f"{one.ratio:.2f}"
    return [one.a, one.b, str(one.n), *(f"{scale * value:.4g}" for value in values), ratio]


def _power(need: Need) -> str:
    if need.power is None or need.power.rate is None:
        return "-"
    text = f"{need.power.rate:.3f}"
    return (
        text
        if need.power.low is None or need.power.high is None
        else f"{text} [{need.power.low:.3f}, {need.power.high:.3f}]"
    )
