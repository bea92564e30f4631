"""How a tuning of traction is told: its JSON document and its tables."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from dynabot_mj.common import tables
from dynabot_mj.common.tables import aligned
from dynabot_mj.controllers.design import design_model
from dynabot_mj.controllers.gains import Gains
from dynabot_mj.experiments.vehicle.parity import Parity
from dynabot_mj.experiments.vehicle.tune_traction import Result, TuningRequest
from dynabot_mj.study import fleet

_AT_BOUND = 0.005  # share of its range within which a gain is at its bound


def document(result: Result, models: Parity) -> dict[str, Any]:
    """Returns the JSON document of the tuning."""
    return {
        "provenance": result.provenance,
        "converged": result.solution.converged,
        "gains": asdict(result.solution.gains),
        "history": result.solution.history,
        "parity_rms_by_range": dict(zip(models.signals, models.error.tolist(), strict=True)),
        "validation": {
            "conditions": [asdict(one) for one in result.validation.conditions],
            "improvement": asdict(result.validation.improvement),
        },
    }


def markdown(result: Result, models: Parity) -> str:
    """Returns the tuning as tables."""
    request, solution, validation = result.request, result.solution, result.validation
    old, new = fleet.gain_set(request.against), solution.gains
    table = [
        [name, *(f"{_value(one, request, name):.4g}" for one in (old, new)), _bounds(name, _value(new, request, name))]
        for name in design_model.free(request.steering)
    ]
    body = [
        [f"{one.friction:g}", f"{one.payload_kg:g}", f"{one.period_ms:g}", *_costs(one.cost_before, one.cost_after)]
        for one in validation.conditions
    ]
    verdict = "better" if validation.better else f"not better than {request.against}"
    verdict += ": adopted" if result.adopted else ": not adopted"
    if not solution.converged:
        verdict += ", the solver did not succeed"
    lines = [
        f"# Tuning of {request.steering}, from {request.start}, seed {request.seed}, T_c = {1e3 * request.period:g} ms",
        "",
        f"IPOPT: {solution.status}, {solution.iterations} iterations; cost in the planar model "
        f"{solution.cost_before:.4f} -> {solution.cost_after:.4f} m^2/s^2",
        "",
        *aligned(["gain", request.against, "tuned", "bounds"], table),
        "",
        f"## Validation in MuJoCo, on {len(validation.cost_before)} courses that the tuning did not use",
        "",
        *aligned(["friction", "payload [kg]", "T_c [ms]", f"cost, {request.against}", "cost, tuned", "change"], body),
        "",
        f"Mean cost {validation.cost_before.mean():.4f} -> {validation.cost_after.mean():.4f} m^2/s^2, improvement "
        f"{tables.difference(validation.improvement, 4)}, paired over courses, 95 %: {verdict}.",
        "",
        "RMS difference of planar model and MuJoCo on the acceptance course, in % of each signal's range: "
        + ", ".join(f"{name} {100.0 * one:.1f}" for name, one in zip(models.signals, models.error, strict=True)),
    ]
    return "\n".join(lines) + "\n"


def _bounds(name: str, tuned: float) -> str:
    """Returns between what a gain was sought, and whether it ended there: the optimum may lie beyond."""
    low, high = design_model.BOUNDS[name]
    near = min(tuned - low, high - tuned) < _AT_BOUND * (high - low)
    return f"{low:g} to {high:g}" + (", at its bound" if near else "")


def _value(gains: Gains, request: TuningRequest, name: str) -> float:
    return float({**asdict(getattr(gains, request.steering)), **asdict(gains.traction)}[name])


def _costs(before: float, after: float) -> Sequence[str]:
    return f"{before:.4f}", f"{after:.4f}", f"{100.0 * (after / before - 1.0):+.0f} %"
