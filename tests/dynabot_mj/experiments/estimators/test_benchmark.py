import json

import numpy as np
import pytest

from dynabot_mj.experiments.estimators import benchmark
from dynabot_mj.perception import estimators


@pytest.fixture(scope="module")
def report():
    return benchmark.filters(robots=2, repetitions=2)


def test_document(report):
    document = benchmark.document(report)["filters"]
    assert json.loads(json.dumps(document, allow_nan=False)) == document
    assert (document["robots"], document["repetitions"]) == (2, 2)
    assert [row["estimator"] for row in document["rows"]] == ["gps", "decoupled", "coupled"]
    assert [row["t_se_ms"] for row in document["rows"]] == pytest.approx([5.9, 13.8, 114.2])
    for row in document["rows"]:
        assert all(value > 0 for key, value in row.items() if key != "estimator")
        assert isinstance(row["operations_fix"], int)
    assert document["coupled_over_gps"]["t_se"] == pytest.approx(114.2 / 5.9)


def test_line_through_both_ekfs(report):
    document = benchmark.document(report)["filters"]
    fit = document["t_se_fit"]
    for row in document["rows"][1:]:
        predicted = fit["offset_ms"] + 1e-3 * fit["us_per_operation"] * row["operations_fix"]
        assert predicted == pytest.approx(row["t_se_ms"])


def test_table(report):
    text = benchmark.markdown(report)
    assert "| coupled " in text
    assert f"{report.rows[2].operations} ({report.rows[2].operations_fix})" in text
    assert "t_se stays a" in text


@pytest.mark.parametrize(("value", "noted"), [(None, True), ("2", True), ("1", False)])
def test_threads_are_noted(monkeypatch, value, noted):
    if value is None:
        monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    else:
        monkeypatch.setenv("OMP_NUM_THREADS", value)
    report = benchmark.filters(robots=1, repetitions=1)
    assert benchmark.document(report)["filters"]["omp_num_threads"] == value
    assert ("OMP_NUM_THREADS" in benchmark.markdown(report)) == noted


@pytest.mark.parametrize("name", estimators.NAMES)
def test_operations_are_at_least_those_of_the_dense_products(name):
    """By hand, of each of FilterPy's filters; models, gates and the like come on top, by less than half."""

    def product(m, k, n):
        return m * n * (2 * k - 1)

    def predicted(s):  # F P F^T + Q
        return 2 * product(s, s, s) + s * s

    def updated(s, m):  # S, K, Joseph's form
        spread = product(s, s, m) + product(m, s, m) + m * m + 2 * m**3 + product(s, m, m)
        joseph = product(s, m, s) + s * s + 2 * product(s, s, s) + product(s, m, m) + product(s, m, s) + s * s
        return spread + joseph + product(s, m, 1) + s

    step, fix = {
        "gps": (predicted(2) + updated(2, 1), 0),
        "decoupled": (3 * predicted(2) + predicted(4) + updated(2, 1), updated(4, 2) + 2 * updated(2, 1)),
        "coupled": (predicted(10) + updated(10, 1), updated(10, 4)),
    }[name]
    without, with_fix = benchmark.operations(name)
    assert step < without < 1.5 * step + 50
    assert fix < with_fix - without < 1.5 * fix + 50


def test_counting_leaves_nothing_behind():
    assert benchmark.operations("coupled") == benchmark.operations("coupled")
    assert isinstance(np.zeros(2) + 1.0, np.ndarray)
