import json
import shutil
from dataclasses import fields, replace
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from dynabot_mj import study
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.formation.scorer import Scores
from dynabot_mj.plants.kinds import KINDS
from dynabot_mj.study import assembly, configuration, provenance, scenario


def test_the_saved_configuration_repeats_the_study(dataset, saved):
    again = configuration.load(dataset.attrs["configuration"], "saved")
    assert saved(study.run(again)) == saved(dataset)


def test_adding_trials_leaves_the_first_ones_unchanged(dataset, short):
    more = study.run(replace(short, trials=5)).isel(trial=slice(0, 3))
    for name in dataset.data_vars:
        np.testing.assert_array_equal(more[name], dataset[name], err_msg=name)


def test_one_trial_can_be_repeated(dataset, short):
    one = study.run(scenario.one_trial(short, "rigid/gauss-markov/gps", 2))
    expected = dataset.sel(case="rigid/gauss-markov/gps", trial=2)
    np.testing.assert_array_equal(one.final_position_w[0, 0], expected.final_position_w)
    assert one.trial.values.tolist() == [2]


def test_dataset_states_units_and_what_it_depends_on(dataset):
    assert {name: dataset[name].attrs["units"] for name in ("settling", "final_position_w", "alpha_h", "time")} == {
        "settling": "s",
        "final_position_w": "m",
        "alpha_h": "N m",
        "time": "s",
    }
    assert "mujoco" in dataset.attrs["versions"]
    assert dataset.attrs["seed"] == 0
    assert dataset.control_period.values.tolist() == [0.027, 0.027]


def test_every_score_is_a_variable_with_its_own_unit_and_meaning(dataset):
    for one in fields(Scores):
        assert dataset[one.name].dims == ("case", "trial")
        assert dataset[one.name].attrs == {"units": one.metadata["unit"], "long_name": one.metadata["meaning"]}


def test_netcdf_round_trip(dataset, tmp_path):
    path = tmp_path / "study.nc"
    study.save(dataset, path)
    xr.testing.assert_identical(study.load(path), dataset)


def test_a_diverged_trial_is_nan_and_counted(monkeypatch, short):
    simulate = assembly.simulate

    def diverging(*args, **options):
        outcome = simulate(*args, **options)
        return replace(outcome, diverged=np.arange(len(outcome.diverged)) == 0)

    monkeypatch.setattr(assembly, "simulate", diverging)
    broken = study.run(replace(short, trials=2))
    assert broken.diverged.values.tolist() == [[1, 0], [1, 0]]
    for name in ("collision", "completion", "top_speed", "closest", "message_age", "final_position_w"):
        assert np.isnan(broken[name][:, 0]).all()
        assert np.isfinite(broken[name][:, 1]).all()
    assert np.isnan(broken.trajectory_w).all()  # of the first trial


def test_a_configuration_that_contradicts_itself_is_refused_before_any_work(short):
    with pytest.raises(InputError, match="mass = 6 kg"):
        study.run(replace(short, mass=6.0))


def test_what_only_rigid_bodies_have_is_nan_for_particles(dataset):
    rigid, particle = dataset.sel(case="rigid/gauss-markov/gps"), dataset.sel(case="particle/gauss-markov/gps")
    for name in ("hull_contact", "wheel_slip"):
        assert np.isnan(particle[name]).all()
        assert np.isfinite(rigid[name]).all()
    assert (rigid.wheel_slip > 0.0).all()
    assert json.loads(dataset.attrs["inputs"]) == provenance.inputs(configuration.load(dataset.configuration, "saved"))


def test_friction_by_trial_is_repeatable_whatever_the_chunks(monkeypatch):
    setup = configuration.build({}, trials=3, duration=3.0, estimators=["gps"], plants=["rigid"], friction=[0.05, 0.9])
    whole = study.run(setup)
    monkeypatch.setitem(KINDS, "rigid", replace(KINDS["rigid"], chunk=1))
    xr.testing.assert_identical(study.run(setup), whole)
    # Other draws than one friction for all.
    same = study.run(replace(setup, vehicle=replace(setup.vehicle, friction="model")))
    assert (same.wheel_slip != whole.wheel_slip).all()


def test_a_study_of_an_older_version_is_read_and_judged_as_today(dataset, tmp_path):
    """Older ones have no first passages, and their common completion counted collisions of centres."""
    old = dataset.drop_vars(["arrival", "formation", "in_band", "contact", "overturned"])
    old["completion_common"] = (("case", "trial"), np.array([[1.0, 1.0, np.nan], [1.0, 0.0, 1.0]]))
    old["collision_footprint"] = (("case", "trial"), np.array([[1.0, 0.0, np.nan], [0.0, 1.0, 0.0]]))
    study.save(old, tmp_path / "study.nc")
    read = study.load(tmp_path / "study.nc")
    np.testing.assert_array_equal(read.completion_common, [[0.0, 1.0, np.nan], [1.0, 0.0, 1.0]])
    assert study.missing(read) == []
    assert study.missing(read.drop_vars("closest")) == ["closest"]


def test_what_cannot_be_written_is_an_error_and_no_crash(dataset, monkeypatch, tmp_path):
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: SimpleNamespace(free=100_000))
    with pytest.raises(OSError, match="No space left"):
        study.save(dataset, tmp_path / "study.nc")
