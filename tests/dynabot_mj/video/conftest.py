import pytest

from dynabot_mj import configuration, opengl
from dynabot_mj.video import take
from dynabot_mj.video.shot import Shot

SMALL = {"width": 480, "height": 272, "rate": 10.0}


def _drawing_fails():
    try:
        with opengl.context(64, 48):
            return ""
    except opengl.GraphicsError as error:
        return str(error)


@pytest.fixture(scope="session")
def graphics():
    """Skips what needs a picture where none can be drawn."""
    if reason := _drawing_fails():
        pytest.skip(reason)


@pytest.fixture(scope="session")
def setup():
    """Rigid robots that do not know exactly where they are."""
    return configuration.build({}, plants=["rigid"], estimators=["decoupled"], trials=1, duration=4.0)


@pytest.fixture(scope="session")
def taken(setup):
    return take.take(setup, Shot(**SMALL), beside=True)
