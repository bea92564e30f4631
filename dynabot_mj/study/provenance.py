"""What a study's numbers depend on: configuration, files, versions, code; equal provenance, equal bytes."""

import functools
import hashlib
import importlib.metadata
import os
import platform
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import dynabot_mj
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.controllers import gains
from dynabot_mj.formation import laws
from dynabot_mj.perception import estimators
from dynabot_mj.plants import scene
from dynabot_mj.study import configuration
from dynabot_mj.study.scenario import Scenario

_SOURCES = (".py", ".xml", ".toml")  # files that results depend on
_LIBRARIES = ("mujoco", "numpy", "scipy", "xarray", "h5netcdf", "h5py")


def depends_on(setup: Scenario) -> dict[str, Any]:
    """Returns what the result of a study depends on, as plain values: where all of it is equal, the bytes are."""
    return {
        **tomllib.loads(configuration.dump(setup)),
        "inputs": inputs(setup),
        "versions": versions(),
        "code": source_digest()[:8],
    }


def inputs(setup: Scenario) -> dict[str, str]:
    """Returns digests of the files that a study reads: results hold for their content, not for their names.

    Raises:
        InputError: If one cannot be read.
    """
    try:
        found = {"model": scene.path(setup.vehicle.model), "gains": gains.path(setup.vehicle.gains)}
        if (law := laws.source(setup.controller)) is not None:
            found["controller"] = law
        for name in dict.fromkeys(setup.estimators):
            own = setup.method[name].filter
            if own is not None and (file := estimators.source(name, own)) is not None:
                found[f"method {name}"] = file
    except FileNotFoundError as error:
        raise InputError(str(error)) from error
    return digests(found)


def digests(files: Mapping[str, Path]) -> dict[str, str]:
    """Returns the digests of some files by name."""
    return {name: hashlib.sha256(file.read_bytes()).hexdigest()[:16] for name, file in files.items()}


def given(setup: Scenario, name: str) -> str:
    """Returns what a study's configuration says of one of its `inputs`."""
    kind, _, method = name.partition(" ")
    if kind == "method":
        return str(setup.method[method].filter)
    return str({"controller": setup.controller, "model": setup.vehicle.model, "gains": setup.vehicle.gains}[name])


@functools.cache
def versions() -> str:
    """Returns the versions that a result depends on, as one line."""
    libraries = (f"{name} {importlib.metadata.version(name)}" for name in _LIBRARIES)
    return ", ".join([f"dynabot-mj {dynabot_mj.__version__}", f"python {platform.python_version()}", *libraries])


@functools.cache
def source_digest() -> str:
    """Returns a digest of our code and models: a resumed study must not mix the results of two versions of them."""
    digest = hashlib.sha256()
    for file in sources():
        digest.update(file.read_bytes())
    return digest.hexdigest()


def computation() -> dict[str, str]:
    """Returns by what this process computes, by name: where it is equal, equal work gives equal bytes."""
    found = dict(one.split(" ", 1) for one in versions().split(", "))
    return {**found, "code": source_digest()[:16]}


def sources() -> Iterator[Path]:
    """Yields the files of the package that results depend on, sorted."""
    # `models`, `controllers` and `estimation` are links in a checkout, which not every Python's rglob follows.
    folders = os.walk(Path(dynabot_mj.__file__).parent, followlinks=True)
    found = (Path(folder) / name for folder, _, names in folders for name in names)
    yield from sorted(file for file in found if file.suffix in _SOURCES)
