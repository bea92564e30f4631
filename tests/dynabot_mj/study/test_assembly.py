import pytest

from dynabot_mj.study import assembly, configuration
from dynabot_mj.study.scenario import Scenario


def test_wells_follow_from_the_number_of_robots():
    three, seven = assembly.field(Scenario(), "gps"), assembly.field(configuration.build({"robots": 7}), "gps")
    assert three.leader.radius == pytest.approx(3.0)
    assert (three.neighbour.range, seven.neighbour.range) == (10.0, 7.5)
    assert seven.leader.radius > three.leader.radius
    assert (three.leader.gain, three.neighbour.gain, three.force_limit) == (300.0, 150.0, 50.0)


def test_perfect_information_is_not_limited_and_options_reach_the_wells():
    assert assembly.field(Scenario(), "perfect").force_limit == float("inf")
    setup = configuration.build({"field": {"closest": 0.2, "width": 0.5}})
    for well in (assembly.field(setup, "gps").leader, assembly.field(setup, "gps").neighbour):
        assert (well.closest, well.width) == (0.2, 0.5)
    ranges = [assembly.field(configuration.build({"robots": n}), "gps").neighbour.range for n in (5, 6)]
    assert ranges == [10.0, 7.5]


def test_footprints_are_the_hulls_with_their_margin_and_the_method_sets_the_tolerance():
    setup = Scenario()
    shape = assembly.formation(setup, "gps")
    assert (shape.length, shape.breadth, shape.tolerance, shape.settling_band) == pytest.approx((0.52, 0.51, 3.5, 0.5))
