import pytest


def test_wheels_that_turn_make_a_vehicle_heavier(vehicle):
    # 12 + 4 * 0.007 / 0.1^2
    assert vehicle.effective_mass == pytest.approx(14.8)


def test_sliding_wheels_turn_a_vehicle_as_a_wider_track_would(vehicle):
    # 0.42 + 0.34^2 / 0.42
    assert vehicle.turning_track == pytest.approx(0.695238, abs=1e-6)


def test_the_largest_current_is_that_of_the_largest_torque(vehicle):
    assert vehicle.current_limit * vehicle.torque_constant == pytest.approx(vehicle.torque_limit)
