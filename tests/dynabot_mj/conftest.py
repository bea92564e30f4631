import pytest

from dynabot_mj import configuration, study


@pytest.fixture(scope="session")
def short():
    """A study that takes a second."""
    return configuration.build({}, trials=3, duration=14.0, estimators=["gps"], plants=["particle", "rigid"])


@pytest.fixture(scope="session")
def dataset(short):
    return study.run(short)


@pytest.fixture
def saved(tmp_path):
    """Returns the bytes of a Dataset as a file."""

    def content(dataset):
        study.save(dataset, tmp_path / "study.nc")
        return (tmp_path / "study.nc").read_bytes()

    return content
