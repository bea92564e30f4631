import signal
from dataclasses import asdict, replace

import casadi
import numpy as np
import pytest

from dynabot_mj.controllers import axes, gains, steering, traction, tuning
from dynabot_mj.controllers.steering import Motion, Reference
from dynabot_mj.controllers.tuning import BOUNDS, Problem

PERIOD = 0.036


@pytest.fixture(scope="module")
def first():
    found = gains.load("first")
    return replace(
        found,
        hand_point=replace(found.hand_point, catch_up=0.4, preview=0.1, yaw_rate_limit=50.0, deadband=0.0),
        heading=replace(found.heading, catch_up=0.4, preview=0.1, yaw_rate_limit=50.0, deadband=0.0),
    )


@pytest.fixture(scope="module")
def problem(vehicle):
    """Two courses of a second and a half: a force from the side that turns, and a well ahead with a robot in it."""
    count = 42
    angle = 0.6 + np.linspace(0.0, 1.5, count)
    turning = 25.0 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return Problem(
        vehicle=vehicle,
        dissipation=13.0,
        well_radius=3.0,
        well_width=1.0,
        spacing=5.2,
        force_w=np.stack([turning, np.zeros((count, 2))]),
        well_gain=np.array([0.0, 500.0]),
        neighbour_gain=np.array([0.0, 230.0]),
        neighbour_w=np.array([[0.0, 0.0], [2.0, 2.5]]),
        start_w=np.array([[0.0, 0.0], [-7.0, -2.0]]),
        period=PERIOD,
        local_periods=1,
    )


def inside(start, law):
    """Returns the gains with those that are tuned within their bounds, where the tuning begins."""
    table = {**asdict(getattr(start, law)), **asdict(start.traction)}
    return tuning._with(start, law, {name: float(np.clip(table[name], *BOUNDS[name])) for name in tuning.free(law)})


def symbolic_steer(table, vehicle):
    v, lag, force = (casadi.SX.sym(name, 2) for name in ("v", "lag", "force"))
    heading, speed = casadi.SX.sym("heading"), casadi.SX.sym("speed")
    out = tuning.steer(v, lag, force, heading, speed, vehicle.mass, PERIOD, table)
    return casadi.Function("steer", [v, lag, force, heading, speed], list(out))


def symbolic_drive(table, vehicle):
    inputs = [casadi.SX.sym(name) for name in ("speed", "acceleration", "turn", "measured", "yaw_rate")]
    return casadi.Function("drive", inputs, list(tuning.drive(*inputs, vehicle, table)))


@pytest.mark.parametrize("law", ["hand_point", "heading"])
@pytest.mark.parametrize(("limit", "tolerance"), [(1e3, 1e-9), (10.0, 1e-3)])
def test_the_symbolic_steering_law_is_the_numeric_one(first, vehicle, law, limit, tolerance):
    own = replace(getattr(first, law), yaw_rate_limit=limit)
    function, random, checked = symbolic_steer(asdict(own), vehicle), np.random.default_rng(1), 0
    for _ in range(200):
        v, lag, force = random.uniform(-2, 2, 2), random.uniform(-0.4, 0.4, 2), random.uniform(-30, 30, 2)
        heading, speed = random.uniform(-3, 3), random.uniform(-2, 2)
        after, motion = steering.steer(
            Reference(velocity_w=v, lag_w=lag),
            force,
            axes.of_heading(np.array(heading)),
            np.array(speed),
            mass=vehicle.mass,
            period=PERIOD,
            gains=own,
        )
        if abs(motion.yaw_rate) > 0.5 * limit:  # away from the limit, which is smooth in symbols
            continue
        found = [np.array(one).ravel() for one in function(v, lag, force, heading, speed)]
        expected = [after.velocity_w, after.lag_w, motion.speed, motion.acceleration, motion.yaw_rate]
        for one, other in zip(found, expected, strict=True):
            # The heading law's angle is kept from the singularity of its arctangent by 1e-9.
            np.testing.assert_allclose(one, np.atleast_1d(other), rtol=tolerance, atol=1e-7)
        checked += 1
    assert checked > 100


@pytest.mark.parametrize("law", ["hand_point", "heading"])
def test_the_symbolic_lag_has_the_same_bound(first, vehicle, law):
    own = getattr(first, law)
    function = symbolic_steer(asdict(own), vehicle)
    v, lag, force = np.array([5.0, 1.0]), np.array([0.7, 0.7]), np.array([30.0, 0.0])
    after, _ = steering.steer(
        Reference(velocity_w=v, lag_w=lag),
        force,
        axes.of_heading(np.array(0.2)),
        np.array(0.0),
        mass=vehicle.mass,
        period=PERIOD,
        gains=own,
    )
    assert np.linalg.norm(after.lag_w) == pytest.approx(own.farthest)
    np.testing.assert_allclose(np.array(function(v, lag, force, 0.2, 0.0)[1]).ravel(), after.lag_w, rtol=1e-9)


@pytest.mark.parametrize(("scale", "tolerance"), [(0.1, 1e-9), (0.45, 1e-3)])
def test_the_symbolic_traction_law_is_the_numeric_one(first, vehicle, scale, tolerance):
    # Limits far away, by the factor that the random motions are scaled with.
    own = replace(first.traction, slip_limit=1.0)
    wide = replace(vehicle, torque_limit=4.0)
    function, random, checked = symbolic_drive(asdict(own), wide), np.random.default_rng(2), 0
    for _ in range(300):
        measured, yaw_rate = random.uniform(-3, 3), random.uniform(-2, 2)
        acceleration, error, turn_error = scale * random.uniform(-1, 1, 3)
        motion = Motion(
            speed=np.array(measured + 0.4 * error),
            acceleration=np.array(4.0 * acceleration),
            yaw_rate=np.array(yaw_rate + turn_error),
        )
        wheel_speed, torque = traction.drive(motion, np.array(measured), np.array(yaw_rate), vehicle=wide, gains=own)
        ground = measured + 0.5 * wide.turning_track * yaw_rate * traction.SIDES
        no_load = wide.wheel_radius * (wheel_speed + torque / wide.servo_gain) - ground
        allowed = own.slip_limit + own.slip_share * np.abs(ground)
        # Smoothed, a value at a share s of its limit is (1 + s^10)^0.1 too small.
        share = max(np.abs(no_load / allowed).max(), np.abs(torque / wide.torque_limit).max())
        if share > 0.5 or (tolerance < 1e-6 and share > 0.12):
            continue
        inputs = (motion.speed, motion.acceleration, motion.yaw_rate, measured, yaw_rate)
        found = [np.array(one).ravel() for one in function(*(float(one) for one in inputs))]
        np.testing.assert_allclose(found[0], wheel_speed, rtol=tolerance, atol=10.0 * tolerance)
        np.testing.assert_allclose(found[1], torque, rtol=tolerance, atol=tolerance)
        checked += 1
    assert checked >= 10


def test_smoothed_limits_are_below_the_sharp_ones_by_7_percent_at_most():
    value, limit = np.linspace(-5.0, 5.0, 101), 1.0
    smooth = np.array(tuning._clip(casadi.DM(value), limit)).ravel()
    sharp = np.clip(value, -limit, limit)
    assert (np.abs(smooth) <= np.abs(sharp) + 1e-12).all()
    assert np.abs(smooth - sharp).max() == pytest.approx(1.0 - 2.0**-0.1, abs=1e-3)


@pytest.mark.parametrize("law", ["hand_point", "heading"])
def test_the_gradient_of_the_cost_is_that_of_finite_differences(first, problem, law):
    own = replace(problem, steering=law)
    names, values = tuning.free(law), tuning._values(own, gains.load("first"))
    # Inside the bounds, where no limit of the laws has a kink.
    low, high = np.array([BOUNDS[name] for name in names]).T
    values = np.clip(values, low + 0.1 * (high - low), high)
    symbol = casadi.MX.sym("g", len(names))
    cost = casadi.sumsqr(tuning._residual(own, gains.load("first"))(symbol))
    function = casadi.Function("cost", [symbol], [cost, casadi.gradient(cost, symbol)])
    slope = np.array(function(values)[1]).ravel()
    for index in range(len(names)):
        step = 1e-5 * np.eye(len(names))[index]
        difference = float(function(values + step)[0] - function(values - step)[0]) / 2e-5
        assert slope[index] == pytest.approx(difference, rel=1e-3, abs=1e-6), names[index]


@pytest.mark.parametrize("law", ["hand_point", "heading"])
def test_tuning_lowers_the_cost_within_the_bounds(problem, law):
    start, told = inside(gains.load("first"), law), []
    solution = tuning.tune(replace(problem, steering=law), start, lambda *now: told.append(now), limit=6)
    assert solution.cost_after < 0.95 * solution.cost_before
    assert len(told) == len(solution.history)
    assert solution.history == [cost for _, cost in told]
    tuned = {**asdict(getattr(solution.gains, law)), **asdict(solution.gains.traction)}
    for name in tuning.free(law):
        low, high = BOUNDS[name]
        assert low - 1e-6 <= tuned[name] <= high + 1e-6, name
    # What is not tuned stays.
    other = "heading" if law == "hand_point" else "hand_point"
    assert getattr(solution.gains, other) == getattr(start, other)
    untouched = set(tuned) - set(tuning.free(law))
    assert {"farthest", "yaw_rate_limit", "deadband"} <= untouched
    before = {**asdict(getattr(start, law)), **asdict(start.traction)}
    assert all(tuned[name] == before[name] for name in untouched)


def test_the_reported_cost_is_that_of_the_reported_gains(problem):
    solution = tuning.tune(problem, gains.load("first"), limit=4)
    values = tuning._values(problem, solution.gains)
    again = float(casadi.sumsqr(tuning._residual(problem, solution.gains)(values)))
    assert again == pytest.approx(solution.cost_after, rel=1e-6)


def test_ctrl_c_is_passed_on(problem):
    seen = []

    def interrupt(iteration, cost):
        seen.append(iteration)
        if iteration == 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        tuning.tune(problem, gains.load("first"), interrupt)
    assert seen[-1] <= 2


def test_the_response_has_the_particle_beside_it(problem):
    response = tuning.respond(problem, gains.load("first"))
    assert response.velocity_w.shape == response.particle_position_w.shape == (2, 42, 2)
    # The particle, by hand: each force held for a period.
    velocity = np.zeros(2)
    for k in range(42):
        velocity = velocity + PERIOD * (problem.force_w[0, k] - 13.0 * velocity) / problem.vehicle.mass
        np.testing.assert_allclose(response.particle_velocity_w[0, k], velocity, atol=1e-12)
    # The vehicle follows it, from rest and from the side, some way behind.
    assert np.linalg.norm(response.velocity_w[0, -1] - velocity) < 0.5 * np.linalg.norm(velocity)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_inside_the_solver_ends_the_tuning_and_is_passed_on(problem, number):
    """Compiled code would swallow what a handler raises, and go on with nonsense."""
    taken, seen = [], []
    before = signal.signal(number, lambda one, frame: taken.append(one))

    def interrupt(iteration, cost):
        seen.append(iteration)
        if iteration == 1:
            signal.raise_signal(number)
            assert not taken  # held back until the solver has stopped

    try:
        tuning.tune(problem, gains.load("first"), interrupt)
    finally:
        signal.signal(number, before)
    assert taken == [number]
    assert seen[-1] <= 2
