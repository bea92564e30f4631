"""Gains of the local laws by optimal control: parameters in, gains out.

IPOPT minimises, over all courses and control periods of the design model, the mean of

    |v - v_p|^2 + w_p |p - p_p|^2  +  soft limits of motor current, wheel slip and yaw acceleration.

It is a sum of squares r.r of gains scaled to their bounds, so the Hessian is taken as 2 J^T J (Gauss-Newton).
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

import casadi
import numpy as np

from dynabot_mj.controllers.design import design_model
from dynabot_mj.controllers.design.design_model import Problem
from dynabot_mj.controllers.design.solving import Progress, Watch, held_back
from dynabot_mj.controllers.gains import Gains


@dataclass(frozen=True, kw_only=True)
class Solution:
    """Outcome of a tuning."""

    gains: Gains
    cost_before: float  # in the design model
    cost_after: float
    iterations: int
    converged: bool
    status: str  # IPOPT's
    history: list[float]  # cost of each iteration


def tune(
    problem: Problem, start: Gains, progress: Progress = lambda iteration, cost: None, limit: int = 100
) -> Solution:
    """Tunes gains.

    Args:
        problem: What for.
        start: Where to begin; gains that are not tuned stay these.
        progress: Called with every iteration.
        limit: Of the iterations.

    Raises:
        KeyboardInterrupt: If it was interrupted.
    """
    names = design_model.free(problem.steering)
    low, high = (np.array([design_model.BOUNDS[name][side] for name in names]) for side in (0, 1))
    share = casadi.MX.sym("share", len(names))
    residual = design_model.residual(problem, start)(low + (high - low) * share)
    slope = casadi.jacobian(residual, share)
    scale, multipliers = casadi.MX.sym("scale"), casadi.MX.sym("multipliers", 0)
    hessian = casadi.triu(2.0 * scale * slope.T @ slope)
    watch = Watch(len(names), progress)
    options: Any = {
        "hess_lag": casadi.Function("hess_lag", [share, casadi.MX(0, 1), scale, multipliers], [hessian]),
        "print_time": False,
        "iteration_callback": watch,
        "ipopt": {
            "print_level": 0,
            "sb": "yes",
            "mu_strategy": "adaptive",
            "max_iter": limit,
            "tol": 1e-4,
            # The laws' limits leave kinks in the cost, at which the gradient need not vanish.
            "acceptable_tol": 1e3,
            "acceptable_iter": 5,
            "acceptable_obj_change_tol": 2e-4,
        },
    }
    solver = casadi.nlpsol("solver", "ipopt", {"x": share, "f": casadi.sumsqr(residual)}, options)
    first = np.array([{**asdict(getattr(start, problem.steering)), **asdict(start.traction)}[name] for name in names])
    with held_back(watch.came):
        result = solver(x0=np.clip((first - low) / (high - low), 0.0, 1.0), lbx=0.0, ubx=1.0)
    if watch.interrupted:
        raise KeyboardInterrupt
    stats = solver.stats()
    # The solver may stop a step or two behind the best point that it has seen; where it broke down, its result is no
    # point at all.
    last = float(result["f"]) if stats["success"] else math.inf
    best = watch.best if watch.lowest <= last else np.array(result["x"]).ravel()
    found = low + (high - low) * best
    before, after = float(casadi.sumsqr(design_model.residual(problem, start)(first))), min(watch.lowest, last)
    # A start outside the bounds may be better than all within them.
    tuned = _with(start, problem.steering, dict(zip(names, found.tolist(), strict=True))) if after < before else start
    return Solution(
        gains=tuned,
        cost_before=before,
        cost_after=min(before, after),
        iterations=int(stats["iter_count"]),
        converged=bool(stats["success"]),
        status=str(stats["return_status"]),
        history=watch.history,
    )


def _with(gains: Gains, steering: str, values: Mapping[str, float]) -> Gains:
    """Returns the gains with some values replaced."""

    def own(table: Any) -> Any:
        return replace(table, **{f.name: values[f.name] for f in fields(table) if f.name in values})

    return replace(gains, traction=own(gains.traction), **{steering: own(getattr(gains, steering))})
