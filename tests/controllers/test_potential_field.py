import casadi
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from dynabot_mj.controllers.potential_field import (
    PotentialField,
    Well,
    attraction,
    polygon_circumradius,
    potential,
    saturate,
    slope,
    total_force,
)

wells = st.builds(
    Well,
    gain=st.floats(1.0, 1000.0),
    radius=st.floats(0.5, 8.0),
    width=st.floats(0.01, 3.0),
    range=st.floats(12.0, 80.0),
)


def kinks(well):
    """Distances at which the slope of V is not smooth, or jumps."""
    return np.array([well.closest, well.radius, well.radius + well.width, well.range])


@given(well=wells, distance=st.floats(0.001, 100.0), bearing=st.floats(-np.pi, np.pi))
def test_force_is_minus_the_numerical_gradient_of_the_potential(well, distance, bearing):
    assume(np.abs(kinks(well) - distance).min() > 1e-3)
    offset = distance * np.array([np.cos(bearing), np.sin(bearing)])
    step = 1e-6
    gradient = [
        (potential(np.hypot(*(offset + d)), well) - potential(np.hypot(*(offset - d)), well)) / (2 * step)
        for d in step * np.eye(2)
    ]
    # V up to 1e5 N m, divided by the step, leaves 1e-5 N of rounding; the third derivative is largest at r = 0.05 m.
    np.testing.assert_allclose(attraction(offset, well), -np.array(gradient), rtol=1e-5, atol=1e-3)


@given(well=wells)
def test_the_potential_is_continuous_everywhere(well):
    below, above = potential(kinks(well) - 1e-9, well), potential(kinks(well) + 1e-9, well)
    np.testing.assert_allclose(below, above, rtol=1e-6, atol=1e-3)


@pytest.mark.parametrize("distance", [0.3, 2.9, 4.5, 30.0])
def test_slope_agrees_with_automatic_differentiation_of_eq_8(distance):
    alpha, h0, eps = 650.0, 3.0, 1.0
    r = casadi.SX.sym("r")
    s = r if distance <= h0 else r - eps
    derivative = casadi.Function("f", [r], [casadi.gradient(alpha * (casadi.log(s) + h0 / s), r)])
    well = Well(gain=alpha, radius=h0, width=eps, range=60.0)
    assert slope(np.array(distance), well) == pytest.approx(float(derivative(distance)), rel=1e-12)


def test_floor_and_far_field_exert_no_force():
    well = Well(gain=650.0, radius=3.0, width=1.0, range=60.0)
    np.testing.assert_array_equal(slope(np.array([3.0, 3.5, 4.0, 60.0001, 1e6]), well), 0.0)
    # "singular at r = 0": finite and repulsive here, and without direction in the very centre.
    assert slope(np.array(0.0), well) == slope(np.array(well.closest), well) < 0.0
    np.testing.assert_array_equal(attraction(np.zeros(2), well), 0.0)


def test_largest_attraction_is_alpha_over_four_h0():
    # d/ds (1/s - h0/s^2) = 0 at s = 2 h0, where the slope is alpha / (4 h0): 54 N for the paper's gains.
    well = Well(gain=650.0, radius=3.0, width=1.0, range=60.0)
    assert slope(np.linspace(4.0, 50.0, 100_001), well).max() == pytest.approx(650.0 / 12.0, rel=1e-8)


def paper_field(limit=np.inf):
    return PotentialField(
        leader=Well(gain=650.0, radius=3.0, width=1.0, range=60.0),
        neighbour=Well(gain=300.0, radius=np.sqrt(27.0), width=1.0, range=10.0),
        dissipation=13.0,
        force_limit=limit,
    )


@given(seed=st.integers(0, 2**32 - 1))
def test_forces_between_robots_cancel(seed):
    position = np.random.default_rng(seed).uniform(-8.0, 8.0, (5, 2))
    known = ~np.eye(5, dtype=bool)
    seen = np.broadcast_to(position, (5, 5, 2))
    far = np.array([1e9, 0.0])  # the leader, out of range
    force = total_force(position, np.zeros((5, 2)), far, seen, known, paper_field())
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-8)


def test_a_robot_nobody_has_heard_exerts_no_force():
    position = np.array([[-40.0, 0.0], [-40.0, 3.0]])
    seen = np.zeros((2, 2, 2))
    nobody = np.zeros((2, 2), dtype=bool)
    alone = total_force(position[:1], np.zeros((1, 2)), np.zeros(2), seen[:1, :1], nobody[:1, :1], paper_field())
    force = total_force(position, np.zeros((2, 2)), np.zeros(2), seen, nobody, paper_field())
    np.testing.assert_array_equal(force[0], alone[0])


def test_saturation_limits_the_norm_of_the_total_command_and_keeps_its_direction():
    force = np.array([[30.0, 40.0], [60.0, -80.0], [0.0, 0.0]])
    np.testing.assert_allclose(saturate(force, 50.0), [[30.0, 40.0], [30.0, -40.0], [0.0, 0.0]])
    np.testing.assert_array_equal(saturate(force, np.inf), force)


def test_dissipation_opposes_the_velocity():
    still = np.array([[3.5, 0.0]])  # on the floor: nothing but dissipation
    nobody = np.zeros((1, 1), dtype=bool)
    args = (np.array([[0.5, -1.0]]), np.zeros(2), np.zeros((1, 1, 2)), nobody)
    np.testing.assert_allclose(total_force(still, *args, paper_field()), [[-6.5, 13.0]])


def test_polygon_of_three_robots_has_the_papers_well():
    assert polygon_circumradius(3.0 * np.sqrt(3.0), 3) == pytest.approx(3.0)
    assert polygon_circumradius(2.0, 6) == pytest.approx(2.0)  # a hexagon's side is its radius
    assert polygon_circumradius(2.0, 2) == pytest.approx(1.0)
