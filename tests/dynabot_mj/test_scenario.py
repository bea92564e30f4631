from dataclasses import replace

import pytest

from dynabot_mj import configuration, scenario
from dynabot_mj.errors import InputError
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


def test_masses_of_the_plants_must_agree():
    scenario.require_mass(Scenario(), 12.0)
    with pytest.raises(InputError, match=r"mass = 10 kg given; .* 12 kg"):
        scenario.require_mass(replace(Scenario(), mass=10.0), 12.0)


def test_one_trial_of_a_study():
    one = scenario.one_trial(Scenario(), "rigid/gauss-markov/coupled", 17)
    assert [case.label for case in scenario.cases(one)] == ["rigid/gauss-markov/coupled"]
    assert (one.first_trial, one.trials) == (17, 1)
