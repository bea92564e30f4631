import mujoco
import pytest

from dynabot_mj import models


@pytest.mark.parametrize("name", ["dynabot.xml", "field.xml", "tether.xml"])
def test_every_file_loads_alone(name):
    assert mujoco.MjModel.from_xml_path(str(models.path(name))).nbody > 1


def test_an_unknown_file_is_refused_with_those_that_exist():
    with pytest.raises(FileNotFoundError, match=r"dynabot\.xml, field\.xml, tether\.xml"):
        models.path("car.xml")
