from dataclasses import asdict, replace

import casadi
import numpy as np
import pytest

from dynabot_mj.controllers import gains
from dynabot_mj.controllers.design import design_model, tuning
from dynabot_mj.controllers.design.design_model import BOUNDS


def inside(start, law):
    """Returns the gains with those that are tuned within their bounds, where the tuning begins."""
    table = {**asdict(getattr(start, law)), **asdict(start.traction)}
    return tuning._with(
        start, law, {name: float(np.clip(table[name], *BOUNDS[name])) for name in design_model.free(law)}
    )


@pytest.mark.parametrize("law", ["hand_point", "heading"])
def test_tuning_lowers_the_cost_within_the_bounds(problem, law):
    start, told = inside(gains.load("first"), law), []
    solution = tuning.tune(replace(problem, steering=law), start, lambda *now: told.append(now), limit=6)
    assert solution.cost_after < 0.95 * solution.cost_before
    assert len(told) == len(solution.history)
    assert solution.history == [cost for _, cost in told]
    tuned = {**asdict(getattr(solution.gains, law)), **asdict(solution.gains.traction)}
    for name in design_model.free(law):
        low, high = BOUNDS[name]
        assert low - 1e-6 <= tuned[name] <= high + 1e-6, name
    # What is not tuned stays.
    other = "heading" if law == "hand_point" else "hand_point"
    assert getattr(solution.gains, other) == getattr(start, other)
    untouched = set(tuned) - set(design_model.free(law))
    assert {"farthest", "yaw_rate_limit", "deadband"} <= untouched
    before = {**asdict(getattr(start, law)), **asdict(start.traction)}
    assert all(tuned[name] == before[name] for name in untouched)


def test_the_reported_cost_is_that_of_the_reported_gains(problem):
    solution = tuning.tune(problem, gains.load("first"), limit=4)
    values = design_model.values(problem, solution.gains)
    again = float(casadi.sumsqr(design_model.residual(problem, solution.gains)(values)))
    assert again == pytest.approx(solution.cost_after, rel=1e-6)
