from dataclasses import replace

import casadi
import numpy as np
import pytest

from dynabot_mj.controllers import gains
from dynabot_mj.controllers.design import design_model
from dynabot_mj.controllers.design.design_model import BOUNDS


@pytest.mark.parametrize("law", ["hand_point", "heading"])
def test_the_gradient_of_the_cost_is_that_of_finite_differences(first, problem, law):
    own = replace(problem, steering=law)
    names, values = design_model.free(law), design_model.values(own, gains.load("first"))
    # Inside the bounds, where no limit of the laws has a kink.
    low, high = np.array([BOUNDS[name] for name in names]).T
    values = np.clip(values, low + 0.1 * (high - low), high)
    symbol = casadi.MX.sym("g", len(names))
    cost = casadi.sumsqr(design_model.residual(own, gains.load("first"))(symbol))
    function = casadi.Function("cost", [symbol], [cost, casadi.gradient(cost, symbol)])
    slope = np.array(function(values)[1]).ravel()
    for index in range(len(names)):
        step = 1e-5 * np.eye(len(names))[index]
        difference = float(function(values + step)[0] - function(values - step)[0]) / 2e-5
        assert slope[index] == pytest.approx(difference, rel=1e-3, abs=1e-6), names[index]


def test_the_response_has_the_particle_beside_it(problem):
    response = design_model.respond(problem, gains.load("first"))
    assert response.velocity_w.shape == response.particle_position_w.shape == (2, 42, 2)
    # The particle, by hand: each force held for a period.
    velocity = np.zeros(2)
    for k in range(42):
        velocity = velocity + problem.period * (problem.force_w[0, k] - 13.0 * velocity) / problem.vehicle.mass
        np.testing.assert_allclose(response.particle_velocity_w[0, k], velocity, atol=1e-12)
    # The vehicle follows it, from rest and from the side, some way behind.
    assert np.linalg.norm(response.velocity_w[0, -1] - velocity) < 0.5 * np.linalg.norm(velocity)
