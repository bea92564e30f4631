import json

import h5py
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


def test_a_study_whose_parts_are_others_is_refused_in_one_line(place, dataset):
    path = place / "study.nc"

    def refused():
        with pytest.raises(InputError) as error:
            studies.load(path)
        return str(error.value)

    whole = path.read_bytes()
    with h5py.File(path, "r+") as file:
        file.attrs["configuration"] = 3
    assert refused().endswith("its configuration is no text")
    study.save(dataset.drop_vars("trial").assign_attrs(trial=3), path)
    assert refused().endswith("it has no trial")
    # A variable of its own length in the place of another: the reader fails in its own way.
    path.write_bytes(whole)
    with h5py.File(path, "r+") as file:
        del file["case"]
        file["case"] = h5py.Empty("f8")
    assert refused().startswith(f"cannot read the study {path}: ")


def test_a_study_that_does_not_say_what_it_read_cannot_be_known_to_be_unchanged(dataset):
    for inputs in ("[1]", "no JSON", "null", 3):
        assert studies.changed_input(dataset.assign_attrs(inputs=inputs)) is not None


def test_the_file_that_a_study_read_and_that_has_changed_is_named(dataset):
    assert studies.changed_input(dataset) is None
    inputs = json.loads(dataset.attrs["inputs"])
    for name in ("model", "gains"):
        assert studies.changed_input(dataset.assign_attrs(inputs=json.dumps({**inputs, name: "0"}))) == name
    # An older study does not say what it read, so nothing is known to be as it was.
    assert studies.changed_input(dataset.drop_attrs().assign_attrs(configuration=dataset.configuration)) is not None
