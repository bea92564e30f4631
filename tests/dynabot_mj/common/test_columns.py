from dataclasses import dataclass

import numpy as np

from dynabot_mj.common import columns
from dynabot_mj.common.arrays import Array


@dataclass(frozen=True)
class Inner:
    a: Array
    share: float


@dataclass(frozen=True)
class Outer:
    inner: Inner
    b: Array
    count: int
    known: bool


def test_a_record_is_the_same_after_its_columns():
    made = Outer(Inner(np.arange(3.0), 0.25), np.array([[True]]), 7, True)
    found = columns.flatten(made)
    assert list(found) == ["inner.a", "inner.share", "b", "count", "known"]
    again = columns.restore(Outer, found)
    np.testing.assert_array_equal(again.inner.a, made.inner.a)
    np.testing.assert_array_equal(again.b, made.b)
    assert (again.inner.share, again.count, again.known) == (0.25, 7, True)
    assert (type(again.inner.share), type(again.count), type(again.known)) == (float, int, bool)
