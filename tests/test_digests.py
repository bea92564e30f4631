"""What commands find is the same bits as when the digests were recorded; see `digests`."""

import importlib.util
import json
from pathlib import Path

import pytest

_SPEC = importlib.util.spec_from_file_location("digests", Path(__file__).with_name("digests.py"))
digests = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(digests)


@pytest.mark.slow
def test_every_number_is_as_it_was(tmp_path, monkeypatch):
    record = json.loads(digests.RECORD.read_text(encoding="utf-8"))
    if record["surroundings"] != digests.surroundings():
        pytest.skip("bits are those of other libraries or of another processor")
    monkeypatch.chdir(tmp_path)
    assert digests.digests(tmp_path) == record["digests"]
