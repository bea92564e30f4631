import json

import pytest

from dynabot_mj import environment
from dynabot_mj.environment import benchmark


@pytest.fixture(scope="module")
def rows():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(benchmark, "_DURATION", 0.4)
        return benchmark.run(robots=2, repetitions=1)


def test_all_kinds_are_measured(rows):
    assert len({(row.estimator, row.action, row.observation) for row in rows}) == len(rows) == 16
    for row in rows:
        assert row.period_ms == pytest.approx(1e3 * environment.load(2, estimator=row.estimator).control_timestep())
        # How long each takes is the machine's: on a busy one the loop, timed a moment later, may take longer.
        assert min(row.environment_us, row.loop_us) > 0.0
        assert row.ratio == pytest.approx(row.loop_us / row.environment_us)


def test_document_and_table(rows):
    document = benchmark.document(rows, 2, 1)
    assert json.loads(json.dumps(document, allow_nan=False)) == document
    assert len(document["environment"]["rows"]) == 16
    assert benchmark.markdown(rows, 2, 1).count("| heard ") == 8
