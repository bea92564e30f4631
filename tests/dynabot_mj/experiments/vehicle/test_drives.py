from types import SimpleNamespace

import numpy as np
import pytest

from dynabot_mj.experiments.vehicle import drives


def test_hulls_meet_at_phases_that_divide_a_step_evenly():
    asked = []
    ground = SimpleNamespace(
        robot=SimpleNamespace(vehicle=SimpleNamespace(length=0.5)),
        rolling_radius=0.1,
        run=lambda duration, speed, **others: asked.append((speed, others)),
    )
    traces = drives._collide(ground, 0.004)
    assert len(traces) == len(asked) == drives.COLLISION_PHASES
    apart = np.array([others["start"][1][0] - others["start"][0][0] for _, others in asked])
    # Two robots of 3 m/s close 24 mm in a step of 4 ms.
    np.testing.assert_allclose(np.diff(apart), 0.024 / drives.COLLISION_PHASES, rtol=1e-9)
    assert apart[0] == pytest.approx(0.5 + 0.6)
    for speed, others in asked:
        assert speed == pytest.approx(30.0)  # of the wheels [rad/s]
        assert others["stop_at_contact"]
        assert np.diff(others["heading"]) == pytest.approx(np.pi)
