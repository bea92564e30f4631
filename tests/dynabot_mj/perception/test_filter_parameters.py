from dataclasses import asdict, fields, replace

import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.estimation.parameters import DEFAULT
from dynabot_mj.perception import filter_parameters
from dynabot_mj.perception.filter_parameters import FilterParameters


def test_defaults_are_those_of_the_filters():
    assert asdict(FilterParameters()) == asdict(DEFAULT)
    filter_parameters.check(DEFAULT)


@pytest.mark.parametrize("name", [field.name for field in fields(DEFAULT)])
@pytest.mark.parametrize("value", [0.0, -1.0, float("inf"), float("nan")])
def test_parameters_out_of_range_are_refused(name, value):
    with pytest.raises(InputError, match=f"filter.{name} = .* given, it must be "):
        filter_parameters.check(replace(DEFAULT, **{name: value}))
