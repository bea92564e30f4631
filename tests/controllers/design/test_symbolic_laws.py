from dataclasses import asdict, replace

import casadi
import numpy as np
import pytest

from dynabot_mj.controllers import axes, steering, traction
from dynabot_mj.controllers.design import symbolic_laws
from dynabot_mj.controllers.steering import Motion, Reference

PERIOD = 0.036


def symbolic_steer(table, vehicle):
    v, lag, force = (casadi.SX.sym(name, 2) for name in ("v", "lag", "force"))
    heading, speed = casadi.SX.sym("heading"), casadi.SX.sym("speed")
    out = symbolic_laws.steer(v, lag, force, heading, speed, vehicle.mass, PERIOD, table)
    return casadi.Function("steer", [v, lag, force, heading, speed], list(out))


def symbolic_drive(table, vehicle):
    inputs = [casadi.SX.sym(name) for name in ("speed", "acceleration", "turn", "measured", "yaw_rate")]
    return casadi.Function("drive", inputs, list(symbolic_laws.drive(*inputs, vehicle, table)))


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
    smooth = np.array(symbolic_laws.clip(casadi.DM(value), limit)).ravel()
    sharp = np.clip(value, -limit, limit)
    assert (np.abs(smooth) <= np.abs(sharp) + 1e-12).all()
    assert np.abs(smooth - sharp).max() == pytest.approx(1.0 - 2.0**-0.1, abs=1e-3)
