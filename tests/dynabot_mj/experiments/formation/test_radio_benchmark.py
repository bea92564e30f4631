import json

import numpy as np
import pytest

from dynabot_mj.experiments.formation import radio_benchmark


@pytest.fixture(scope="module")
def rows(small_loop):
    return radio_benchmark.run(repetitions=1)


def test_all_numbers_of_robots_are_measured(rows):
    assert [row.robots for row in rows] == [2, 3, 4, 5, 6, 7]
    assert rows[1].period_ms == pytest.approx(36.0)
    for row in rows:
        numbers = [row.messages_per_second, row.event_us, row.loop_event_us, row.share]
        assert np.isfinite(numbers).all()
        assert min(numbers) > 0.0
        assert row.share == pytest.approx(row.event_us / row.loop_event_us)


def test_document_and_table(rows):
    document = radio_benchmark.document(rows, 1)
    assert json.loads(json.dumps(document, allow_nan=False)) == document
    assert document["radio"]["trials"] == 2
    lines = [line for line in radio_benchmark.markdown(rows, 1).splitlines() if line.startswith("| ")]
    assert len(lines) == 7
