"""Studies that were saved: read and checked, and whether their trials can be repeated here."""

import json
from pathlib import Path

import xarray as xr

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.host import user_code
from dynabot_mj.study import configuration, dataset, provenance


def load(place: Path) -> tuple[xr.Dataset, Path]:
    """Reads a saved study.

    Args:
        place: Its file, or the folder of its results.

    Returns:
        The Dataset and its file.

    Raises:
        InputError: If there is none, or it cannot be read.
    """
    path = place / "study.nc" if place.is_dir() else place
    if not path.is_file():
        raise InputError(f"there is no study at {path}")
    try:
        saved = dataset.load(path)
    except Exception as error:  # which one depends on where the file is broken
        raise InputError(f"cannot read the study {path}: {' '.join(str(error).split())}") from error
    for name, there in (("configuration", saved.attrs), ("case", saved.coords), ("trial", saved.coords)):
        if name not in there:
            raise InputError(f"the study {path} is not as it was saved: it has no {name}")
    if not isinstance(saved.attrs["configuration"], str):
        raise InputError(f"the study {path} is not as it was saved: its configuration is no text")
    user_code.look_in(_folder(path))  # of laws and estimators of the user's
    labels = [entry.label for entry in dataset.campaign_of(saved, str(path)).entries]
    if labels != saved.case.values.tolist():
        raise InputError(f"the study {path} is not as it was saved: configured are the cases {', '.join(labels)}")
    return saved, path


def _folder(path: Path) -> Path | None:
    """Returns the working directory that a saved study was run in; None where nothing says it."""
    try:
        return Path(json.loads(path.with_name("execution.json").read_text(encoding="utf-8"))["folder"])
    except (OSError, ValueError, TypeError, KeyError):
        return None


def changed_input(saved: xr.Dataset) -> str | None:
    """Returns which of the files that a saved study read has changed since; None where its trials can be repeated."""
    try:
        was = dict(json.loads(saved.attrs.get("inputs", "{}")))  # older studies do not say
    except (TypeError, ValueError, RecursionError):
        was = {}
    setup = configuration.load(saved.attrs["configuration"], "the study's configuration")
    return next((name for name, digest in provenance.inputs(setup).items() if was.get(name) != digest), None)
