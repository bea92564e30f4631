"""Trees of plain values, as TOML and JSON have them."""

from collections.abc import Iterator, Mapping
from typing import Any

_TOLD = 3  # differences that a message names


def flat(tree: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yields the values of a tree by dotted name, as `radio.message_bytes`."""
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from flat(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def differences(there: Mapping[str, Any], here: Mapping[str, Any]) -> dict[str, tuple[Any, Any]]:
    """Returns in what two trees differ, by dotted name; what one of them does not have is "none" there."""
    one, other = dict(flat(there)), dict(flat(here))
    both = {name: (one.get(name, "none"), other.get(name, "none")) for name in {**other, **one}}
    return {name: pair for name, pair in both.items() if pair[0] != pair[1]}


def told(found: Mapping[str, tuple[Any, Any]]) -> str:
    """Says what `differences` has found, in as many words as a line has room for."""
    text = ", ".join(f"{name} {there} there and {here} here" for name, (there, here) in list(found.items())[:_TOLD])
    return text + (f", and {len(found) - _TOLD} more" if len(found) > _TOLD else "")
