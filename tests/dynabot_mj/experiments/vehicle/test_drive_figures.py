"""How figures are read off traces; the figures themselves are judged in `test_drive`."""

import numpy as np
import pytest

from dynabot_mj.controllers.vehicle import GRAVITY
from dynabot_mj.experiments.vehicle import drive_figures

TIME = 0.004 * np.arange(501)


def test_a_level_is_reached_between_samples():
    assert drive_figures._when(TIME, 3.0 * TIME, 1.0) == pytest.approx(1.0 / 3.0, abs=1e-12)
    assert drive_figures._when(TIME, 3.0 * TIME, 6.1) is None
    assert drive_figures._when(TIME, 3.0 * TIME + 1.0, 0.5) == 0.0  # it was there from the start


def test_a_peak_is_the_mean_over_20_ms_whatever_the_step():
    for step in (0.001, 0.002, 0.005):
        time = step * np.arange(round(0.1 / step) + 1)
        speed = np.clip(time - 0.03, 0.0, 0.02)  # 1 m/s^2 for 20 ms
        assert drive_figures._peak(speed, time) == pytest.approx(1.0 / GRAVITY, rel=1e-9)


def test_a_speed_is_steady_where_its_last_quarter_grows_by_less_than_a_hundredth():
    steady, growing = np.minimum(TIME, 1.0)[:, None], TIME[:, None]
    assert drive_figures._is_steady(steady)
    assert not drive_figures._is_steady(growing)


def test_a_spread_is_by_the_size_of_the_mean():
    assert drive_figures._spread([-1.9, -2.0, -2.1]) == pytest.approx(0.1)
