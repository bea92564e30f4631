import pytest

from dynabot_mj import study
from dynabot_mj.study import configuration


@pytest.fixture(scope="session")
def perceptions():
    """Two seconds of every perception, on both plants."""
    return study.run(
        configuration.build(
            {"perception": ["gauss-markov", "filter", "fitted"]},
            trials=2,
            duration=2.0,
            estimators=["perfect", "gps", "decoupled"],
        )
    )
