import numpy as np
import pytest

from dynabot_mj.estimation.measurements import GpsFix


@pytest.fixture
def fix():
    """One robot's fix, which was true 0.1 s ago."""
    return GpsFix(
        received=np.array(True),
        position_w=np.array([10.0, 20.0]),
        velocity_w=np.array([0.0, 3.0]),
        age=np.array(0.1),
    )
