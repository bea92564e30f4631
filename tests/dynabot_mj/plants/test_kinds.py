import numpy as np
import pytest

from dynabot_mj.plants.kinds import KINDS, PLANTS, any_bodies
from dynabot_mj.study import configuration, fleet
from dynabot_mj.study.scenario import Case


def test_every_kind_has_a_record():
    assert set(KINDS) == set(PLANTS)


@pytest.mark.parametrize("name", PLANTS)
def test_a_configuration_makes_every_kind_and_bodies_have_wheels(name):
    setup, case = configuration.build({}), Case(plant=name, perception="gauss-markov", estimator="gps")
    heading = np.zeros((1, 3))
    position_w = np.array([[[0.0, 0.0], [3.0, 0.0], [0.0, 3.0]]])
    plant = fleet.plant(setup, case, position_w, heading, range(1))
    np.testing.assert_allclose(plant.state.position_w, position_w, atol=1e-6)
    assert hasattr(plant, "wheel_slip") == KINDS[name].body


def test_looks_tell_kinds_apart():
    for look in ("label", "line", "opacity"):
        assert len({getattr(one, look) for one in KINDS.values()}) == len(KINDS)


def test_whether_there_are_bodies():
    assert any_bodies(["particle", "rigid"])
    assert not any_bodies(["particle"])
