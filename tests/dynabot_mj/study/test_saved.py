import json

import pytest
import xarray as xr

from dynabot_mj import study
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.study import saved as studies


@pytest.fixture
def place(dataset, tmp_path):
    study.save(dataset, tmp_path / "study.nc")
    return tmp_path


def test_a_study_is_found_by_its_folder_and_by_its_file(place, dataset):
    for given in (place, place / "study.nc"):
        found, path = studies.load(given)
        assert path == place / "study.nc"
        xr.testing.assert_identical(found, dataset)


def test_what_is_no_study_is_told_with_its_path(place, tmp_path):
    with pytest.raises(InputError, match=f"there is no study at {tmp_path / 'absent'}"):
        studies.load(tmp_path / "absent")
    (place / "study.nc").write_bytes(b"no study")
    with pytest.raises(InputError, match=f"cannot read the study {place / 'study.nc'}: "):
        studies.load(place)


def test_the_file_that_a_study_read_and_that_has_changed_is_named(dataset):
    assert studies.changed_input(dataset) is None
    inputs = json.loads(dataset.attrs["inputs"])
    for name in ("model", "gains"):
        assert studies.changed_input(dataset.assign_attrs(inputs=json.dumps({**inputs, name: "0"}))) == name
    # An older study does not say what it read, so nothing is known to be as it was.
    assert studies.changed_input(dataset.drop_attrs().assign_attrs(configuration=dataset.configuration)) is not None
