from dataclasses import replace

import pytest

from dynabot_mj import scenario
from dynabot_mj.errors import InfeasibleScheduleError, InputError
from dynabot_mj.scenario import Scenario


def test_toml_gives_the_same_scenario_back():
    setup = scenario.build({"robots": 5, "method": {"gps": {"alpha_h": 310.0}}}, seed=7, utilisation=0.95)
    assert scenario.load(scenario.dump(setup), "text") == setup


def test_precedence_is_defaults_then_file_then_options():
    text = "trials = 7\nseed = 3\n[method.gps]\nalpha_h = 310\n[start]\ndistance = 40.0"
    setup = scenario.load(text, "study.toml", seed=4, headings="leader", duration=None)
    assert (setup.trials, setup.seed, setup.duration) == (7, 4, 80.0)
    assert (setup.method.gps.alpha_h, setup.method.gps.alpha_d) == (310.0, 150.0)
    assert (setup.start.distance, setup.start.headings) == (40.0, "leader")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("bogus = 1", "unknown key bogus"),
        ("[field]\nmass = 1", "unknown key field.mass"),
        ("mass = -1", "mass = -1: input should be greater than 0"),
        ("trials = '3'", "trials = '3': input should be a valid integer"),
        ("trials = 0", "greater than or equal to 1"),
        ("robots = 9", "robots = 9: input should be less than or equal to 7"),
        ("robots = 0", "robots = 0"),
        ("duration = nan", "duration = nan"),
        ("duration = inf", "duration = inf"),
        ("duration = 0.001", "at least the control period of perfect, 0.01 s"),
        ("estimators = ['foo']", "'perfect', 'gps', 'decoupled' or 'coupled'"),
        ("plants = []", "at least 1 item"),
        ("field = 3", "field = 3"),
        ("method = 3", "method = 3"),
        ("[method.gps]\nforce_limit = nan", "method.gps.force_limit = nan"),
        ("[method.gps]\nsample_period = 0.0305", "whole number of timer ticks"),
        ("[method.gps]\nuncertainty = 0.0", "positive for all others"),
        ("[processor]\nutilisation = 1.7", "utilisation = 1.7"),
        ("trials = ", "study.toml is not TOML"),
    ],
)
def test_nonsense_is_named_in_one_line(text, message):
    with pytest.raises(InputError) as error:
        scenario.load(text, "study.toml")
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_infeasible_periods_are_refused():
    with pytest.raises(InfeasibleScheduleError, match="load the processor"):
        scenario.load("[method.coupled]\nsample_period = 0.05", "study.toml")


def test_files_that_cannot_be_read(tmp_path):
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(InputError, match="not a text file"):
        scenario.load_file(binary)
    with pytest.raises(InputError, match="No such file"):
        scenario.load_file(tmp_path / "absent.toml")


def test_periods_of_table_iii_in_ticks():
    setup = Scenario()
    assert [scenario.periods(setup, name) for name in scenario.ESTIMATORS] == [(10, 10), (27, 27), (36, 36), (156, 156)]
    table_i = scenario.build({}, utilisation=0.95)
    assert [scenario.periods(table_i, name)[0] for name in scenario.ESTIMATORS] == [10, 29, 39, 166]


def test_control_may_be_slower_or_faster_than_sampling():
    text = "[method.gps]\nsample_period = 0.027\ncontrol_period = 0.054\n[method.coupled]\ncontrol_period = 0.1"
    setup = scenario.load(text, "study.toml", utilisation=1.0, estimators=["gps"])
    assert scenario.periods(setup, "gps") == (27, 54)


def test_perfect_information_appears_once_per_plant():
    labels = [case.label for case in scenario.cases(Scenario())]
    assert labels[:4] == ["particle/perfect", "rigid/perfect", "particle/gauss-markov/gps", "rigid/gauss-markov/gps"]
    assert len(labels) == len(set(labels)) == 8


def test_wells_follow_from_the_number_of_robots():
    three, seven = scenario.field(Scenario(), "gps"), scenario.field(scenario.build({"robots": 7}), "gps")
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
