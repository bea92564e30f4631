from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.controllers import gains
from dynabot_mj.controllers.design.design_model import Problem


@pytest.fixture(scope="module")
def first():
    found = gains.load("first")
    return replace(
        found,
        hand_point=replace(found.hand_point, catch_up=0.4, preview=0.1, yaw_rate_limit=50.0, deadband=0.0),
        heading=replace(found.heading, catch_up=0.4, preview=0.1, yaw_rate_limit=50.0, deadband=0.0),
    )


@pytest.fixture(scope="module")
def problem(vehicle):
    """Two courses of a second and a half: a force from the side that turns, and a well ahead with a robot in it."""
    count = 42
    angle = 0.6 + np.linspace(0.0, 1.5, count)
    turning = 25.0 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return Problem(
        vehicle=vehicle,
        dissipation=13.0,
        well_radius=3.0,
        well_width=1.0,
        spacing=5.2,
        force_w=np.stack([turning, np.zeros((count, 2))]),
        well_gain=np.array([0.0, 500.0]),
        neighbour_gain=np.array([0.0, 230.0]),
        neighbour_w=np.array([[0.0, 0.0], [2.0, 2.5]]),
        start_w=np.array([[0.0, 0.0], [-7.0, -2.0]]),
        period=0.036,
        local_periods=1,
    )
