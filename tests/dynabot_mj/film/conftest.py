import pytest

from dynabot_mj.film import take
from dynabot_mj.film.shot import Shot
from dynabot_mj.study import configuration

SMALL = {"width": 480, "height": 272, "rate": 10.0}


@pytest.fixture(scope="session")
def setup():
    """Rigid robots that do not know exactly where they are."""
    return configuration.build({}, plants=["rigid"], estimators=["decoupled"], trials=1, duration=4.0)


@pytest.fixture(scope="session")
def taken(setup):
    return take.take(setup, Shot(**SMALL), beside=True)
