"""Records of arrays as named columns, and back: what a file can hold that must not run code."""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any, TypeVar, get_type_hints

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Columns = Mapping[str, npt.NDArray[Any]]
Record = TypeVar("Record", bound="DataclassInstance")


def flatten(record: "DataclassInstance") -> dict[str, npt.NDArray[Any]]:
    """Returns the arrays and numbers of a record by name; those of records in it as `inner.name`."""
    found: dict[str, npt.NDArray[Any]] = {}
    for one in fields(record):
        value = getattr(record, one.name)
        if is_dataclass(value) and not isinstance(value, type):
            found |= {f"{one.name}.{name}": array for name, array in flatten(value).items()}
        else:
            found[one.name] = np.asarray(value)
    return found


def restore(kind: type[Record], columns: Columns) -> Record:
    """Returns the record that `flatten` made columns of."""
    hints = get_type_hints(kind)
    values: dict[str, Any] = {}
    for one in fields(kind):
        hint = hints[one.name]
        if is_dataclass(hint) and isinstance(hint, type):
            prefix = f"{one.name}."
            inner = {name.removeprefix(prefix): array for name, array in columns.items() if name.startswith(prefix)}
            values[one.name] = restore(hint, inner)
        else:
            array = columns[one.name]
            values[one.name] = array.item() if hint in (bool, int, float) else array
    return kind(**values)
