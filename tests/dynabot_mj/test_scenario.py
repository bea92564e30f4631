import pytest

from dynabot_mj import configuration, scenario
from dynabot_mj.scenario import Scenario


def test_periods_of_table_iii_in_ticks():
    setup = Scenario()
    assert [scenario.periods(setup, name) for name in scenario.ESTIMATORS] == [(10, 10), (27, 27), (36, 36), (156, 156)]
    table_i = configuration.build({}, utilisation=0.95)
    assert [scenario.periods(table_i, name)[0] for name in scenario.ESTIMATORS] == [10, 29, 39, 166]


def test_control_may_be_slower_or_faster_than_sampling():
    text = "[method.gps]\nsample_period = 0.027\ncontrol_period = 0.054\n[method.coupled]\ncontrol_period = 0.1"
    setup = configuration.load(text, "study.toml", utilisation=1.0, estimators=["gps"])
    assert scenario.periods(setup, "gps") == (27, 54)


def test_perfect_information_appears_once_per_plant():
    labels = [case.label for case in scenario.cases(Scenario())]
    assert labels[:4] == ["particle/perfect", "rigid/perfect", "particle/gauss-markov/gps", "rigid/gauss-markov/gps"]
    assert len(labels) == len(set(labels)) == 8


def test_wells_follow_from_the_number_of_robots():
    three, seven = scenario.field(Scenario(), "gps"), scenario.field(configuration.build({"robots": 7}), "gps")
    assert three.leader.radius == pytest.approx(3.0)
    assert (three.neighbour.range, seven.neighbour.range) == (10.0, 7.5)
    assert seven.leader.radius > three.leader.radius
    assert (three.leader.gain, three.neighbour.gain, three.force_limit) == (300.0, 150.0, 50.0)


def test_perfect_information_is_not_limited_and_options_reach_the_wells():
    assert scenario.field(Scenario(), "perfect").force_limit == float("inf")
    setup = configuration.build({"field": {"closest": 0.2, "width": 0.5}})
    for well in (scenario.field(setup, "gps").leader, scenario.field(setup, "gps").neighbour):
        assert (well.closest, well.width) == (0.2, 0.5)
    ranges = [scenario.field(configuration.build({"robots": n}), "gps").neighbour.range for n in (5, 6)]
    assert ranges == [10.0, 7.5]


def test_loads_are_those_of_the_rounded_periods():
    loads = scenario.loads(Scenario())
    assert {name: round(load, 4) for name, load in loads.items()} == {
        "gps": 1.0015,
        "decoupled": 1.0106,
        "coupled": 0.9999,
    }


def test_one_trial_of_a_study():
    one = scenario.one_trial(Scenario(), "rigid/gauss-markov/coupled", 17)
    assert [case.label for case in scenario.cases(one)] == ["rigid/gauss-markov/coupled"]
    assert (one.first_trial, one.trials) == (17, 1)
