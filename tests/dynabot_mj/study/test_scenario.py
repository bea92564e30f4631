import numpy as np
import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.controllers import gains
from dynabot_mj.controllers.steering import HandPoint, Heading
from dynabot_mj.plants import scene
from dynabot_mj.study import assembly, configuration, fleet, provenance, scenario
from dynabot_mj.study.scenario import Scenario


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


def test_conditions_are_those_of_the_vehicle():
    assert fleet.conditions(Scenario()) == scene.NOMINAL
    setup = configuration.build({}, friction=0.4, slope=0.1, payload=2.0)
    assert fleet.conditions(setup) == scene.Conditions(friction=0.4, slope=0.1, payload=2.0)
    # What differs by trial is not the conditions'.
    assert fleet.conditions(configuration.build({}, friction=[0.3, 0.9])).friction is None


def test_friction_is_drawn_for_each_trial_by_its_number():
    setup = configuration.build({}, friction=[0.3, 0.9], seed=5)
    found = fleet.friction(setup, range(400))
    assert ((found >= 0.3) & (found <= 0.9)).all()
    assert len(np.unique(found)) == 400
    # Uniform: mean 0.6, standard deviation 0.6 / sqrt(12).
    assert found.mean() == pytest.approx(0.6, abs=4.0 * 0.6 / np.sqrt(12 * 400))
    np.testing.assert_array_equal(fleet.friction(setup, [7, 3]), found[[7, 3]])
    other = configuration.build({}, friction=[0.3, 0.9], seed=6)
    assert not np.isin(fleet.friction(other, range(400)), found).any()


@pytest.mark.parametrize("given", ["model", 0.4])
def test_friction_that_does_not_differ_is_not_drawn(given):
    assert fleet.friction(configuration.build({}, friction=given), range(3)) is None


def test_a_range_of_one_value_is_that_value():
    setup = configuration.build({}, friction=[0.4, 0.4])
    np.testing.assert_array_equal(fleet.friction(setup, range(3)), 0.4)


def test_the_particle_weighs_what_the_robot_weighs_with_its_payload():
    assert fleet.mass(Scenario()) == pytest.approx(12.0)
    setup = configuration.build({}, payload=3.5)
    assert fleet.mass(setup) == pytest.approx(15.5)
    assert fleet.mass(configuration.build({"mass": 15.5}, payload=3.5)) == 15.5
    with pytest.raises(InputError, match=r"mass = 12 kg given; .* the model's and its payload, 15.5 kg"):
        configuration.build({"mass": 12.0}, payload=3.5)
    # Particles alone may weigh what they like.
    assert fleet.mass(configuration.build({"mass": 7.0}, plants=["particle"])) == 7.0


def test_laws_are_those_of_the_gain_set():
    first = gains.load("first")
    laws = fleet.local_laws(configuration.build({}, gains="first"))
    assert isinstance(laws.steering, HandPoint)
    assert (laws.steering, laws.traction, laws.on_board) == (first.hand_point, first.traction, True)
    laws = fleet.local_laws(configuration.build({}, gains="first", steering="heading", sensing="truth"))
    assert isinstance(laws.steering, Heading)
    assert (laws.steering, laws.on_board) == (first.heading, False)


def test_inputs_change_with_what_is_in_the_files(tmp_path):
    file = tmp_path / "mine.toml"
    text = gains.path("first").read_text(encoding="utf-8")
    file.write_text(text, encoding="utf-8")
    setup = configuration.build({}, gains=str(file))
    before = provenance.inputs(setup)
    assert before == provenance.inputs(configuration.build({}, gains="first"))
    file.write_text(text + "# a remark\n", encoding="utf-8")
    after = provenance.inputs(setup)
    assert after["model"] == before["model"]
    assert after["gains"] != before["gains"]
    file.unlink()
    with pytest.raises(InputError, match="must be a gain file or one of"):
        provenance.inputs(setup)
