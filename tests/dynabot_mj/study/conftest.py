from dataclasses import replace

import pytest

from dynabot_mj.plants import kinds
from dynabot_mj.study import campaign, trial_chunks


@pytest.fixture
def chunked(monkeypatch):
    """Makes chunks of a size; of two trials unless told otherwise."""

    def resize(size):
        for name, kind in kinds.KINDS.items():
            monkeypatch.setitem(kinds.KINDS, name, replace(kind, chunk=size))

    resize(2)
    return resize


@pytest.fixture
def work():
    """Returns the chunks of a study."""
    return lambda setup: trial_chunks.chunks(campaign.single(setup))
