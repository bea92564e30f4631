from dataclasses import replace

import pytest

from dynabot_mj.study import provenance

pytestmark = pytest.mark.usefixtures("chunked")


def test_parts_of_another_version_of_the_code_are_not_taken(monkeypatch, short, work):
    def first(setup):
        return work(setup)[0].file_name

    name = first(short)
    assert first(replace(short, seed=1)) != name
    assert first(replace(short, trials=9)) == first(replace(short, plants=("particle",))) == name
    monkeypatch.setattr(provenance, "source_digest", lambda: "another")
    assert first(short) != name
