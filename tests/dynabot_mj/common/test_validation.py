from dataclasses import asdict

import pytest
from pydantic import TypeAdapter, ValidationError

from dynabot_mj.common import validation
from dynabot_mj.common.trees import flat
from dynabot_mj.experiments.estimators import circle
from dynabot_mj.study.scenario import Scenario

BAD = [float("nan"), float("inf"), -1.0]


@pytest.mark.parametrize(
    ("kind", "good", "bad"),
    [
        (validation.Positive, [1e-9, 1e6], [*BAD, 0.0, 1.1e6]),
        (validation.NotNegative, [0.0, 1e6], [*BAD, 1.1e6]),
        (validation.Share, [0.0, 1.0], [*BAD, 1.1]),
    ],
    ids=["positive", "not negative", "share"],
)
def test_numbers_are_taken_up_to_their_bounds(kind, good, bad):
    judge = TypeAdapter(kind)
    assert [judge.validate_python(value) for value in good] == good
    for value in bad:
        with pytest.raises(ValidationError):
            judge.validate_python(value)


def test_every_unit_is_of_a_key_that_there_is():
    keys = {name.rpartition(".")[2] for one in (Scenario(), circle.CircleRequest()) for name, _ in flat(asdict(one))}
    assert set(validation.UNITS) <= keys, set(validation.UNITS) - keys
