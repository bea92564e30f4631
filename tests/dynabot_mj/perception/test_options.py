from dataclasses import asdict, fields, replace
from pathlib import Path

import numpy as np
import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.estimation.parameters import DEFAULT
from dynabot_mj.perception import options
from dynabot_mj.perception.estimators import NAMES
from dynabot_mj.perception.options import FilterOptions, FilterParameters, FittedOptions
from dynabot_mj.study import configuration


def test_filters_assume_what_the_estimators_do_by_default():
    assumed = FilterOptions()
    assert {name: getattr(assumed, name) for name in vars(DEFAULT)} == vars(DEFAULT)


@pytest.mark.parametrize("name", [name for name in NAMES if hasattr(FittedOptions(), name)])
def test_fitted_errors_are_about_as_large_as_the_filters(name):
    # The position errors in the loop that docs/estimation.md tells: 1.25, 0.74 and 0.70 m per axis.
    error = getattr(FittedOptions(), name)
    expected = {"gps": 1.25, "decoupled": 0.74, "coupled": 0.70}[name]
    assert np.sqrt(sum(one.deviation**2 for one in error.position)) == pytest.approx(expected, abs=0.01)
    assert error.velocity
    assert error.heading


def test_the_fitted_default_is_its_file_which_a_study_takes_too():
    text = Path(options.__file__).with_name("fitted.toml").read_text(encoding="utf-8")
    assert text.startswith("#")  # how it was made
    assert configuration.load(text, "the default").fitted == FittedOptions()


def test_parts_that_are_not_given_are_exact():
    position = [{"deviation": 1.0, "time": 2.0}]
    setup = configuration.build({"fitted": {"gps": {"position": position}}})
    assert setup.fitted.gps.velocity == setup.fitted.gps.heading == ()
    assert setup.fitted.coupled == FittedOptions().coupled


def test_defaults_are_those_of_the_filters():
    assert asdict(FilterParameters()) == asdict(DEFAULT)
    options.check(DEFAULT)


@pytest.mark.parametrize("name", [field.name for field in fields(DEFAULT)])
@pytest.mark.parametrize("value", [0.0, -1.0, float("inf"), float("nan")])
def test_parameters_out_of_range_are_refused(name, value):
    with pytest.raises(InputError, match=f"filter.{name} = .* given, it must be "):
        options.check(replace(DEFAULT, **{name: value}))
