from dynabot_mj.study import configuration, scenario
from dynabot_mj.study.scenario import Case, Scenario


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


def test_by_default_the_velocity_is_true_where_it_is_exact():
    setup = Scenario()

    def case(plant, estimator, perception="gauss-markov"):
        return Case(plant=plant, estimator=estimator, perception=None if estimator == "perfect" else perception)

    assert scenario.velocity(setup, case("rigid", "perfect")) == "truth"
    assert scenario.velocity(setup, case("rigid", "gps")) == "truth"
    assert scenario.velocity(setup, case("particle", "gps", "filter")) == "estimate"
    assert scenario.velocity(setup, case("rigid", "gps", "fitted")) == "estimate"
