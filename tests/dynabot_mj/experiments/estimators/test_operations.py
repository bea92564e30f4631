import numpy as np
import pytest

from dynabot_mj.experiments.estimators.operations import Counted, Tally


def operations(function, *values):
    tally = Tally()
    result = function(*(Counted(np.asarray(value, dtype=float), tally) for value in values))
    return tally.count, result


A, B, V = np.arange(6.0).reshape(2, 3), np.arange(12.0).reshape(3, 4), np.array([1.0, 2.0, 4.0])


@pytest.mark.parametrize(
    ("function", "values", "count"),
    [
        (lambda a, b: a @ b, (A, B), 2 * 4 * (3 + 2)),
        (np.dot, (A, B), 2 * 4 * (3 + 2)),
        (lambda a, b: a.dot(b), (A, B), 2 * 4 * (3 + 2)),
        (lambda a, v: a @ v, (A, V), 2 * (3 + 2)),
        (lambda v, w: v @ w, (V, V), 3 + 2),
        (lambda a, b: a[None] @ b[None, None], (A, B), 2 * 4 * (3 + 2)),
        (np.dot, (A, 2.0), 6),
        (np.outer, (V, V), 9),
        (np.linalg.inv, (np.eye(4),), 2 * 4**3),
        (lambda a: a + a, (A,), 6),
        (lambda v: 2.0 * v / 3.0 - 1.0, (V,), 9),
        (lambda v: v.sum(), (V,), 2),
        (lambda v: v[0] * v[1] + np.exp(v[2]), (V,), 3),
        (lambda v: v[:2] ** 2, (V,), 2),
        (lambda a: -np.concatenate([a, a]).T.copy(), (A,), 0),
        (lambda a: a[0] > 1.0, (A,), 0),
    ],
)
def test_known_counts(function, values, count):
    found, result = operations(function, *values)
    assert found == count
    np.testing.assert_array_equal(np.asarray(result), function(*values))


def test_an_array_changed_in_place_counts():
    tally, plain = Tally(), np.ones(3)
    plain += Counted(V, tally)
    assert tally.count == 3
    np.testing.assert_array_equal(plain, V + 1.0)


def test_what_comes_of_counting_arrays_counts():
    count, result = operations(lambda a, b: a @ b, A, B)
    assert isinstance(result, Counted)
    total = result + 1.0
    assert total._tally.count == count + 8


def test_functions_of_unknown_cost_are_refused():
    with pytest.raises(NotImplementedError, match="cost of svd"):
        operations(np.linalg.svd, A)
    with pytest.raises(NotImplementedError, match=r"cost of add.accumulate"):
        operations(np.add.accumulate, V)
