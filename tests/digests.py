"""Digests of what commands find, to move code without moving a number.

`python tests/digests.py` prints them, `python tests/digests.py --record` writes digests.json, for a change that is
meant to change numbers. Bits depend on the libraries and on the processor's instructions, so that digests are compared
only where both are those of the record.
"""

import contextlib
import hashlib
import json
import platform
import sys
import tempfile
from importlib import metadata
from pathlib import Path

import numpy as np
import xarray as xr

from dynabot_mj import cli, environment

RECORD = Path(__file__).with_name("digests.json")
LAW = "def law(known):\n    return 20.0 * (known.leader_w - known.position_w) - 13.0 * known.velocity_w\n"
SLOWER_CONTROL = "[method.decoupled]\nsample_period = 0.036\ncontrol_period = 0.108\n"
SHORT = ("--trials", "6", "--duration", "40")
PARTICLES = ("--plants", "particle", "--estimators", "decoupled", "coupled")
POWER = ("--cases", "particle/gauss-markov/decoupled", "particle/gauss-markov/coupled")
COMMANDS = {
    "compare": ("compare", *SHORT, "--perception", "gauss-markov", "filter", "fitted"),
    "compare --friction": ("compare", *SHORT, "--plants", "rigid", "--friction", "0.3..0.9"),
    "compare --velocity estimate": ("compare", *SHORT, "--velocity", "estimate"),
    "compare --velocity odometry": ("compare", *SHORT, "--velocity", "odometry", "--plants", "rigid"),
    "compare --controller": ("compare", *SHORT, "--controller", "digested_law:law", "--estimators", "gps"),
    "compare T_c > T_s": ("compare", *SHORT, "--config", "slower.toml", "--estimators", "decoupled"),
    "compare --robots": ("compare", *SHORT, "--steering", "heading", "--estimators", "coupled", "--robots", "5"),
    "compare pilot": ("compare", "--trials", "12", "--duration", "50", *PARTICLES),
    "power means": ("power", "compare_pilot", *POWER, "--measure", "arrival_s", "--difference", "-0.1"),
    "power rates": ("power", "compare_pilot", *POWER, "--measure", "completion_common", "--difference", "20"),
    "circle": ("circle", "--runs", "4", "--duration", "40", "--log", "log.csv"),
    "circle rigid": ("circle", "--runs", "2", "--duration", "40", "--plant", "rigid"),
    "drive": ("drive",),
    "estimate": ("estimate", "log.csv"),
    "track": ("track", "--trials", "2"),
    "tune traction": ("tune", "traction"),
}
NAMES = (*COMMANDS, "environment")


def surroundings() -> dict[str, str]:
    """Returns what bits depend on beside our code."""
    names = ("numpy", "scipy", "mujoco", "casadi", "xarray")
    versions = {name: metadata.version(name) for name in names}
    features = np.show_config(mode="dicts")["SIMD Extensions"]
    return {**versions, "python": platform.python_version(), "instructions": " ".join(features["found"])}


def digests(folder: Path, names=NAMES) -> dict[str, str]:
    """Runs commands in a folder, which must be the working directory, and digests what they leave."""
    (folder / "digested_law.py").write_text(LAW, encoding="utf-8")
    (folder / "slower.toml").write_text(SLOWER_CONTROL, encoding="utf-8")
    found = {}
    for name in names:
        if name == "environment":
            found[name] = _digest(_episodes())
            continue
        place = folder / name.replace(" ", "_").replace(">", "")
        assert cli.main([*COMMANDS[name], "--out", str(place)]) == 0, name
        found[name] = _digest(_content(place))
    return found


def _content(place: Path):
    """Yields the numbers of a folder of results."""
    for file in sorted(place.iterdir()):
        if file.suffix == ".nc":
            with xr.open_dataset(file, engine="h5netcdf") as study:
                yield study.attrs["configuration"].encode()
                for name in sorted(study.variables):
                    values = study[name].values
                    yield name.encode()
                    yield repr(values.tolist()) if values.dtype.kind in "OUS" else values.tobytes()
        elif file.suffix in (".csv", ".json", ".toml") and file.name not in ("execution.json", "tuning.json"):
            yield file.name
            yield file.read_text(encoding="utf-8")


def _episodes():
    """Yields what is seen and rewarded in an episode of each kind of action."""
    for action, observation in (("force", "truth"), ("force", "heard"), ("wheels", "heard")):
        made = environment.load(action=action, observation=observation, duration=5.0, seed=3)
        specification = made.action_spec()
        step = made.reset()
        draws = np.random.default_rng(0)
        while not step.last():
            step = made.step(draws.uniform(-5.0, 5.0, specification.shape))
            yield repr(step.reward)
            for key in sorted(step.observation):
                yield np.asarray(step.observation[key], dtype=float).tobytes()


def _digest(parts) -> str:
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part if isinstance(part, bytes) else part.encode())
    return digest.hexdigest()[:16]


def _main() -> None:
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder), contextlib.redirect_stdout(sys.stderr):
        found = digests(Path(folder))
    if "--record" in sys.argv:
        record = {"surroundings": surroundings(), "digests": found}
        RECORD.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(found, indent=1))


if __name__ == "__main__":
    _main()
