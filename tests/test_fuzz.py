"""Whatever is read from files and options either works, or is refused in one line: no traceback, no hang.

`make fuzz` tries 10,000 inputs in place of the 300 of the suite.
"""

import contextlib
import datetime
import hashlib
import io
import json
import math
import os
import re
import select
import signal
import subprocess
import sys
import tempfile
import zipfile
from dataclasses import asdict
from pathlib import Path

import h5py
import numpy as np
import pytest
import tomli_w
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from dynabot_mj import models, study
from dynabot_mj.common.exceptions import DynabotError
from dynabot_mj.controllers import gains
from dynabot_mj.experiments.estimators import kinematic
from dynabot_mj.sensing import replay
from dynabot_mj.sensing.logs import log
from dynabot_mj.sensing.options import SensorOptions, WheelErrors
from dynabot_mj.study import campaign, chunk_files, configuration
from dynabot_mj.study.scenario import Scenario

SUITE = 300  # inputs, of all kinds
INPUTS = int(os.environ.get("DYNABOT_FUZZ", SUITE))
TIME_LIMIT = 20  # of one input [s]
KINDS = {  # of files, and what one is called
    "csv": "log.csv",
    "nc": "log.nc",
    "study": "study.nc",
    "chunk": "part.npz",
    "gains": "gains.toml",
    "robot": "robot.xml",
    "toml": "study.toml",
}
pytestmark = pytest.mark.skipif(not hasattr(signal, "SIGALRM"), reason="no time limits on this system")
READER = Path(__file__).with_name("fuzz_reader.py")


def inputs(count):
    """Returns the settings of a test that has so many of the suite's inputs."""
    return settings(
        max_examples=max(1, round(count * INPUTS / SUITE)), suppress_health_check=[*HealthCheck], print_blob=False
    )


def check_message(message):
    assert message.strip()
    assert message.isprintable(), f"not one line of text: {message!r}"


@contextlib.contextmanager
def refused_at_most():
    """What runs in it works, or is refused in one line, in time."""

    def late(number, frame):
        raise TimeoutError(f"takes longer than {TIME_LIMIT} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(TIME_LIMIT)
    try:
        yield
    except DynabotError as error:
        check_message(str(error))
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


class Reader:
    """The process that reads files, and is started again when one has killed it."""

    def __init__(self, folder):
        self._folder, self._process = folder, None

    def read(self, kind, content):
        """Returns the message that a file is refused with; None: it is read."""
        path = self._folder / KINDS[kind]
        path.write_bytes(content)
        if self._process is None:
            self._errors = (self._folder.parent / "errors.txt").open("w+b")
            self._process = subprocess.Popen(
                [sys.executable, "-P", READER],  # not with `tests` first, whose folders have the packages' names
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._errors,
                cwd=self._folder,
            )
            self._ask("csv", self._folder / "absent.csv", 120)  # imports take their time
        answer = self._ask(kind, path, TIME_LIMIT)
        assert "raised" not in answer, answer["raised"]
        left = {one.name for one in self._folder.iterdir()} - {*KINDS.values()}
        assert not left, f"reading left files: {left}"
        if "refused" in answer:
            check_message(answer["refused"])
        return answer.get("refused")

    def _ask(self, kind, path, seconds):
        self._process.stdin.write(f"{kind} {path}\n".encode())
        self._process.stdin.flush()
        ready, _, _ = select.select([self._process.stdout], [], [], seconds)
        line = self._process.stdout.readline() if ready else b""
        if not line:
            told = "died" if ready else f"takes longer than {seconds} s"
            self.end()
            raise AssertionError(f"reading {kind} {told}: {self._last}")
        return json.loads(line)

    def end(self):
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._errors.seek(0)
            self._last = self._errors.read().decode(errors="replace")[-3000:]
            self._errors.close()
            self._process = None


@pytest.fixture(scope="module")
def reader(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fuzz") / "inputs"
    folder.mkdir()
    made = Reader(folder)
    yield made
    made.end()


# What is put in the place of something that was right.

WORDS = (
    *("0", "-1", "1", "2", "7", "1e-300", "1e300", "1e999", "nan", "inf", "-inf", "0.5", "1_0", "1" * 400, "1" * 5000),
    *(
        "true",
        "",
        "auto",
        "none",
        "'",
        '"',
        '""',
        "\n",
        "\0",
        "\\",
        "[]",
        "[[]]",
        "{}",
        "{a = 1}",
        "[1, 2]",
        "é",
        "\ud7ff",
    ),
    *("=", ",", "#", "[", "]", "<", ">", "/>", "&", "&#0;", "..", "2026-01-01", "[" * 3000, "a." * 3000, "%s", "{}"),
)
TOKEN = re.compile(r"[\w.+-]+|[^\w\s]|\n")


@st.composite
def mutated(draw, text):
    """Returns a text with some of its words or lines replaced, repeated or left out."""
    edits = st.tuples(st.sampled_from(["word", "word", "drop", "line", "twice", "cut", "other"]), st.floats(0.0, 0.999))
    for kind, place in draw(st.lists(edits, min_size=1, max_size=3)):
        tokens = list(TOKEN.finditer(text))
        if not tokens:
            break
        token = tokens[int(place * len(tokens))]
        start, end = token.span()
        if kind in ("line", "twice"):
            start, end = text.rfind("\n", 0, start) + 1, (text.find("\n", start) + 1 or len(text))
        new = {
            "word": lambda: draw(st.sampled_from(WORDS) | st.text(max_size=4)),
            "twice": lambda: text[start:end] * 2,  # noqa: B023
            "other": lambda: draw(st.sampled_from(tokens)).group(),  # noqa: B023
        }.get(kind, str)()
        text = text[:start] + new + ("" if kind == "cut" else text[end:])
    return text


class Content(bytes):
    """Of a file, too long to be printed: the one that fails is kept in the folder of the tests."""

    def __repr__(self):
        return f"<{len(self)} bytes>" if len(self) > 1000 else super().__repr__()


@st.composite
def damaged(draw, data):
    """Returns bytes some of which are others, gone or more."""
    edits = st.tuples(st.sampled_from(["set", "set", "set", "flip", "drop", "more", "cut"]), st.floats(0.0, 0.999))
    for kind, place in draw(st.lists(edits, min_size=1, max_size=6)):
        at = int(place * len(data))
        new, length = draw(st.binary(min_size=1, max_size=8) | st.sampled_from([b"\0" * 8, b"\xff" * 8])), 0
        if kind == "set":
            length = len(new)
        elif kind == "flip" and data:
            new, length = bytes([data[at] ^ (1 << draw(st.integers(0, 7)))]), 1
        elif kind == "drop":
            new, length = b"", draw(st.integers(1, 64))
        elif kind == "cut":
            new, length = b"", len(data)
        data = data[:at] + new + data[at + length :]
    return Content(data)


@st.composite
def edited(draw, data):
    """Returns an HDF5 file that is whole, but has variables or attributes that are gone or others."""
    buffer = io.BytesIO(data)
    values = st.sampled_from(
        (
            *("", "x", "a\nb", "\x1b[2J", "[1]", "{}", "null", "robots = 9", b"\xff\xfe", 1, -1.5, math.nan),
            *(np.arange(3), np.zeros((2, 2)), np.array(["a", "b"], dtype=object), np.zeros(0), h5py.Empty("f8")),
            *(np.array([True]), np.array([1 + 2j]), "seconds since 1970-01-01", "days since x", "case trial"),
        )
    )
    with h5py.File(buffer, "r+") as file:
        for _ in range(draw(st.integers(1, 2))):
            names = sorted(file)
            name = draw(st.sampled_from(names))
            place = draw(st.sampled_from([file, file[name]])) if name in file else file
            kind = draw(st.sampled_from(["attribute", "attribute", "drop attribute", "drop", "replace", "value"]))
            value = draw(values)
            with contextlib.suppress(TypeError, ValueError, OSError, KeyError, RuntimeError):  # not all can be written
                if kind == "attribute":
                    place.attrs[draw(st.sampled_from([*sorted(place.attrs), "units", "coordinates", "_FillValue"]))] = (
                        value
                    )
                elif kind == "drop attribute" and place.attrs:
                    del place.attrs[draw(st.sampled_from(sorted(place.attrs)))]
                elif kind == "value":
                    file[name][...] = value
                else:
                    del file[name]
                    if kind == "replace":
                        file[name] = value
    return Content(buffer.getvalue())


# Configurations.

DEFAULTS = configuration.parsed(configuration.dump(Scenario()), "the default")
PATHS = sorted(configuration._keys(asdict(Scenario())))
NAMES = sorted({part for path in PATHS for part in path.split(".")})
LAWS = ("", ":", "a:b", "math:pi", "math:sqrt", "numpy:add", "random:random", "..:x", "dynabot_mj:absent", "a b:c\n")
SCALARS = (
    st.booleans()
    | st.integers(-2, 9)
    | st.sampled_from([10**6, 2**31, 2**63, 2**64, 10**400, -(10**400)])
    | st.floats()
    | st.sampled_from([0.0, 0.012, 0.036, 1.0, 5.0, 20.0, 100.0, 1e6, 1e308, math.inf, -math.inf, math.nan])
    | st.sampled_from(["auto", "model", "gps", "coupled", "perfect", "rigid", "particle", "filter", "fitted", "tuned"])
    | st.sampled_from(["a\nb", "\0", "x" * 300, "/", ".", "é\u2028", "{}", "%d", "\x1b[2J", "gps ", "../a", *LAWS])
    | st.text(max_size=5)
    | st.sampled_from([datetime.date(2026, 1, 1), datetime.time(1, 2)])
)
KEYS = st.sampled_from([*NAMES, "grid", "zip"]) | st.sampled_from(["a b", "a\nb", "", "a.b", "robot", "Trials", "é"])
VALUES = st.recursive(SCALARS, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(KEYS, inner, max_size=3))


class Nested(dict):
    """Tables in tables, too many of them to be printed."""

    def __init__(self, depth):
        tree = {}
        for _ in range(depth):
            tree = {"a": tree}
        super().__init__(tree)

    def __repr__(self):
        return "Nested(...)"


@st.composite
def trees(draw):
    """Returns a configuration with some keys that are right, and some that are not."""
    tree = {}
    for _ in range(draw(st.integers(1, 4))):
        path = draw(st.sampled_from(PATHS)).split(".")
        if draw(st.integers(0, 5)) == 0:
            path[draw(st.integers(0, len(path) - 1))] = draw(KEYS)
        put(tree, path, draw(st.one_of(SCALARS, SCALARS, VALUES, st.builds(Nested, st.sampled_from([3, 3000])))))
    return tree


def put(tree, path, value):
    *tables, last = path
    for table in tables:
        if not isinstance(tree.get(table), dict):
            tree[table] = {}
        tree = tree[table]
    tree[last] = value


@inputs(55)
@given(tree=trees(), options=st.dictionaries(st.sampled_from(["robots", "utilisation", "payload", "mass"]), SCALARS))
def test_a_configuration_of_any_values_is_built_or_refused(tree, options):
    with refused_at_most():
        setup = configuration.build(tree, **options)
        assert configuration.load(configuration.dump(setup), "a copy") == setup


@st.composite
def grids(draw):
    def table():
        found = {}
        for _ in range(draw(st.integers(0, 2))):
            path = draw(st.sampled_from(["robots", "duration", "controller", "method.gps.alpha_h", *PATHS]))
            path = path.split(".") if draw(st.booleans()) else [path]
            values = draw(st.lists(SCALARS, max_size=3) | st.lists(st.integers(2, 8), max_size=4, unique=True) | VALUES)
            put(found, path if draw(st.integers(0, 5)) else [draw(KEYS)], values)
        return found

    grid = table()
    if draw(st.booleans()):
        grid["zip"] = draw(st.one_of(st.just(table()), st.just(table()), VALUES))
    return draw(st.one_of(st.just(grid), st.just(grid), st.just(grid), VALUES))


@inputs(45)
@given(grid=grids(), tree=st.just({}) | st.just({"robots": 4, "plants": ["particle"]}) | trees())
def test_a_campaign_of_any_grid_is_built_or_refused(grid, tree):
    with refused_at_most():
        made = campaign.load({**tree, "grid": grid}, "study.toml")
        labels = [entry.label for entry in made.entries]
        assert all(label.isprintable() for label in labels)
        assert campaign.parse(made.text, "a copy").points == made.points


@pytest.mark.parametrize(
    "text",
    [
        '[grid]\n"a\\nb" = [1]',
        '[grid]\n"a\\nb" = 1',
        '[grid]\ncontroller = ["a\\nb"]',
        "[grid]\n" + "a." * 3000 + "a = [1]",
        "[grid.zip]\n" + "a." * 3000 + "a = [1]",
        "[grid]\nmass = [" + "1" * 400 + "]",
        "[grid]\nmass = [0x" + "f" * 5000 + ", 1]",
    ],
)
def test_a_grid_that_once_was_no_single_line_is_refused(text):
    with pytest.raises(DynabotError) as error:
        campaign.parse(text, "study.toml")
    check_message(str(error.value))


# Files.


def content(write, name):
    """Returns the bytes that a function writes."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        write(path)
        return path.read_bytes()


def a_log():
    truth = kinematic.follow("circle", 1, 5, 2.0, 0.018)
    return log.from_run(replay.record(truth, SensorOptions(), 0.036, 5), truth, 0, WheelErrors())


def a_study():
    setup = configuration.build({}, trials=1, duration=1.0, estimators=["gps", "perfect"], plants=["particle"])
    return study.run(setup)


LOG = a_log()
CSV = content(lambda path: log.write(path, LOG), "log.csv").decode()
LOG_NC = content(lambda path: log.write(path, LOG), "log.nc")
STUDY = content(lambda path: study.save(a_study(), path), "study.nc")
CHUNK = chunk_files.content({"a": np.arange(6.0), "scores.b": np.zeros((2, 3), bool)}, {"trials": [0, 6], "c": "x"})
GAINS = gains.path("tuned").read_text(encoding="utf-8")
TOML = tomli_w.dumps(DEFAULTS)
ROBOT = models.path("dynabot.xml").read_text(encoding="utf-8")


def encoded(text):
    return Content(text.encode(errors="surrogatepass"))


def test_what_is_mutated_is_read_as_it_is(reader):
    right = {
        "csv": CSV.encode(),
        "nc": LOG_NC,
        "study": STUDY,
        "chunk": CHUNK,
        "gains": GAINS.encode(),
        "robot": ROBOT.encode(),
        "toml": TOML.encode(),
    }
    assert {*right} == {*KINDS}
    for kind, data in right.items():
        assert reader.read(kind, data) is None, kind


@inputs(45)
@given(
    data=mutated(TOML).map(encoded)
    | mutated("robots = 4\n[radio]\nmessage_bytes = 40\n").map(encoded)
    | st.text().map(encoded)
    | damaged(TOML.encode())
)
def test_a_configuration_of_any_text_is_read_or_refused(reader, data):
    reader.read("toml", data)


@inputs(30)
@given(data=mutated("\n".join(CSV.splitlines()[:12]) + "\n").map(encoded) | damaged(CSV.encode()))
def test_a_log_in_csv_is_read_or_refused(reader, data):
    reader.read("csv", data)


@inputs(20)
@given(data=damaged(LOG_NC) | edited(LOG_NC))
def test_a_log_in_netcdf_is_read_or_refused(reader, data):
    reader.read("nc", data)


@inputs(25)
@given(data=damaged(STUDY) | edited(STUDY))
def test_a_study_is_read_or_refused(reader, data):
    reader.read("study", data)


def sealed(data):
    """Returns the part of a study with the checksum that fits it, as if somebody had written it so."""
    body = data[: -64 - 2]
    return Content(body + (64).to_bytes(2, "little") + hashlib.sha256(body).hexdigest().encode())


def packed(members):
    """Returns an archive of any members, as a part of a study."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(name, data)
    return sealed(buffer.getvalue()[:-2] + bytes(66))


MEMBERS = st.dictionaries(
    st.sampled_from(["origin.json", "a.npy", "b.npy", "c", "../d.npy"]),
    st.sampled_from([b"{}", b"[]", b"null", b"[" * 100_000, b"{\xff", b"1" * 5000, b"\x93NUMPY", b"", b"\x80\x04N."])
    | damaged(
        b"\x93NUMPY\x01\x00v\x00{'descr': '<f8', 'fortran_order': False, 'shape': (1,), }"
        + b" " * 59
        + b"\n"
        + bytes(8)
    ),
)


@inputs(25)
@given(data=damaged(CHUNK) | damaged(CHUNK).map(sealed) | MEMBERS.map(packed))
def test_a_part_of_a_study_is_read_or_refused(reader, data):
    reader.read("chunk", data)


@inputs(25)
@given(data=mutated(GAINS).map(encoded) | damaged(GAINS.encode()))
def test_a_gain_file_is_read_or_refused(reader, data):
    reader.read("gains", data)


@inputs(30)
@given(data=mutated(ROBOT).map(encoded) | damaged(ROBOT.encode()))
def test_a_robot_is_read_or_refused(reader, data):
    reader.read("robot", data)
