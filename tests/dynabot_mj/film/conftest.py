from dataclasses import replace

import pytest

from dynabot_mj.film import film, take
from dynabot_mj.film.shot import OVERLAYS, Shot
from dynabot_mj.study import configuration

SMALL = {"width": 480, "height": 272, "rate": 10.0}
K = 30  # a frame in the middle of the film


@pytest.fixture(scope="session")
def setup():
    """Rigid robots that do not know exactly where they are."""
    return configuration.build({}, plants=["rigid"], estimators=["decoupled"], trials=1, duration=4.0)


@pytest.fixture(scope="session")
def taken(setup):
    return take.take(setup, Shot(**SMALL), beside=True)


def picture(taken, k=K, only=None, **changes):
    overlays = frozenset(OVERLAYS if only is None else only)
    shot = replace(Shot(**SMALL), overlays=overlays, **changes)
    with film.opened(taken, shot) as drawn:
        return drawn.frame(k).astype(int)
