"""Finished parts of a study as files: columns with what they depend on and a checksum, and nothing that could run.

A file is NumPy's `.npz`, a ZIP archive with an array for each column and the origin as JSON; the archive's comment is
the SHA-256 digest of all that stands before it. The same columns are the same bytes.
"""

import hashlib
import io
import json
import zipfile
from collections.abc import Mapping
from typing import Any

import numpy as np

from dynabot_mj.common.columns import Columns

SUFFIX = ".npz"
_ORIGIN = "origin.json"
_DIGEST = 64  # characters
_LENGTH = 2  # bytes of the comment's length, the last of an archive without comment


class DamagedError(Exception):
    """A file is not as it was written."""


def content(columns: Columns, origin: Mapping[str, Any]) -> bytes:
    """Returns the bytes of a file.

    Args:
        columns: Arrays of numbers, by name.
        origin: What they depend on, as plain values.
    """
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **{name: np.asarray(columns[name]) for name in sorted(columns)})
    with zipfile.ZipFile(buffer, "a") as archive:
        archive.writestr(zipfile.ZipInfo(_ORIGIN), json.dumps(origin))
    whole = buffer.getvalue()
    digest = hashlib.sha256(whole[:-_LENGTH]).hexdigest().encode()
    return whole[:-_LENGTH] + len(digest).to_bytes(_LENGTH, "little") + digest


def parse(data: bytes) -> tuple[Columns, dict[str, Any]]:
    """Returns the columns of a file's bytes, and what they depend on.

    Raises:
        DamagedError: If they are not those of `content`.
    """
    length = (_DIGEST).to_bytes(_LENGTH, "little")
    body, found, digest = data[: -_DIGEST - _LENGTH], data[-_DIGEST - _LENGTH : -_DIGEST], data[-_DIGEST:]
    if found != length or hashlib.sha256(body).hexdigest().encode() != digest:
        raise DamagedError("its checksum does not fit")
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            origin = json.loads(archive.read(_ORIGIN))
        with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
            columns = {name: arrays[name] for name in arrays.files if name != _ORIGIN}
    except (ValueError, KeyError, OSError, zipfile.BadZipFile, RecursionError, NotImplementedError) as error:
        raise DamagedError("it is no part of a study") from error
    if not isinstance(origin, dict):
        raise DamagedError("it is no part of a study")
    return columns, origin
