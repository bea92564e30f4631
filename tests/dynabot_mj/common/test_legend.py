import pytest

from dynabot_mj.common import legend


def test_colours_as_red_green_and_blue():
    assert legend.rgb("#ff0033") == pytest.approx((1.0, 0.0, 0.2))
