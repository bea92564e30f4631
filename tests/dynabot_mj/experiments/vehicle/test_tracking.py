import math
from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.controllers import gains
from dynabot_mj.experiments.vehicle import manoeuvres, tracking
from dynabot_mj.experiments.vehicle.manoeuvres import Manoeuvre
from dynabot_mj.plants.local_laws import LocalLaws

TUNED = gains.load("tuned")
LAWS = LocalLaws(steering=TUNED.hand_point, traction=TUNED.traction)


def test_the_particle_beside_the_vehicle_is_the_one_of_the_equations():
    courses = manoeuvres.sampled([Manoeuvre(kind="circle", force=0.0), Manoeuvre(kind="step", force=26.0)], 2.0, 0.02)
    particle = tracking.follow(courses, LAWS).particle
    np.testing.assert_array_equal(particle.velocity_w[0], 0.0)
    # m dv/dt = F - c v with v sampled: v_k = F / c (1 - (1 - c T / m)^k) until the force reverses.
    k = np.arange(1, 51)
    expected = 26.0 / 13.0 * (1.0 - (1.0 - 13.0 * 0.02 / 12.0) ** k)
    np.testing.assert_allclose(particle.velocity_w[1, :50, 0], expected, rtol=1e-9)


def test_a_force_ahead_is_followed_closely_and_one_to_the_side_later():
    asked = [Manoeuvre(kind="step", force=26.0, direction=angle) for angle in (0.0, math.pi / 2.0)]
    found = tracking.follow(manoeuvres.sampled(asked, 2.0, 0.036), LAWS)
    ahead, aside = found.position_error
    assert ahead < aside < 0.6
    assert found.cost(0.1) == pytest.approx(found.velocity_error**2 + 0.1 * found.position_error**2)


def test_part_takes_the_same_courses_of_everything():
    asked = [Manoeuvre(kind="step", force=force) for force in (10.0, 20.0, 30.0)]
    found = tracking.follow(manoeuvres.sampled(asked, 0.5, 0.036), LAWS)
    np.testing.assert_array_equal(found.part(slice(1, None, 2)).velocity_error, found.velocity_error[1::2])


def test_gains_change_what_is_measured():
    asked = [Manoeuvre(kind="well", gain=650.0, distance=8.0, direction=1.0)]
    courses = manoeuvres.sampled(asked, 3.0, 0.036)
    dull = replace(LAWS, traction=replace(TUNED.traction, yaw_gain=0.0, scrub_torque=0.0))
    assert tracking.follow(courses, dull).velocity_error[0] > tracking.follow(courses, LAWS).velocity_error[0]
