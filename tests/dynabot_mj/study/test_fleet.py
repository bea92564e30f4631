import numpy as np
import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.controllers import gains
from dynabot_mj.controllers.steering import HandPoint, Heading
from dynabot_mj.plants import scene
from dynabot_mj.study import configuration, fleet
from dynabot_mj.study.scenario import Scenario


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
