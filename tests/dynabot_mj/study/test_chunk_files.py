import io
import json
import pickle

import numpy as np
import pytest

from dynabot_mj.study import chunk_files
from dynabot_mj.study.chunk_files import DamagedError

COLUMNS = {"scores.arrival": np.array([1.0, np.nan, np.inf]), "diverged": np.array([True, False, False])}
ORIGIN = {"trials": [0, 3], "case": {"plant": "particle"}}


@pytest.fixture(scope="module")
def data():
    return chunk_files.content(COLUMNS, ORIGIN)


def test_what_is_written_is_read(data):
    columns, origin = chunk_files.parse(data)
    assert origin == ORIGIN
    assert set(columns) == set(COLUMNS)
    for name, values in COLUMNS.items():
        np.testing.assert_array_equal(columns[name], values)
        assert columns[name].dtype == values.dtype


def test_equal_columns_are_equal_bytes(data):
    assert chunk_files.content(dict(reversed(COLUMNS.items())), ORIGIN) == data


def test_numpy_reads_it_too(data):
    with np.load(io.BytesIO(data), allow_pickle=False) as found:
        np.testing.assert_array_equal(found["diverged"], COLUMNS["diverged"])


def test_every_bit_counts(data):
    for place in range(len(data)):
        flipped = bytearray(data)
        flipped[place] ^= 1 << place % 8
        with pytest.raises(DamagedError):
            chunk_files.parse(bytes(flipped))


def test_every_byte_counts(data):
    for length in range(len(data)):
        with pytest.raises(DamagedError):
            chunk_files.parse(data[:length])


def test_it_holds_nothing_that_could_run(data):
    with pytest.raises(ValueError, match="allow_pickle"):
        chunk_files.content({"a": np.array([object()])}, {})
    with pytest.raises(DamagedError):
        chunk_files.parse(pickle.dumps(COLUMNS))


def test_the_origin_is_plain(data):
    with pytest.raises(TypeError):
        chunk_files.content(COLUMNS, {"a": object()})
    assert json.loads(json.dumps(ORIGIN)) == ORIGIN
