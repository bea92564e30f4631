import pytest

from dynabot_mj.common import legend


def test_a_colour_means_one_robot_one_method_or_one_perception():
    colours = [*legend.ROBOT_COLOURS, *legend.METHOD_COLOURS.values(), *legend.PERCEPTION_COLOURS.values()]
    assert len(set(colours)) == len(colours) == 7 + 4 + 3


def test_a_method_is_named_with_its_perception_where_one_is_given():
    assert legend.method("gps") == "GPS"
    assert legend.method("gps", "filter") == "GPS, filters"


def test_colours_as_red_green_and_blue():
    assert legend.rgb("#ff0033") == pytest.approx((1.0, 0.0, 0.2))
