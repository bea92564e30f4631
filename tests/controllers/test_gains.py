import tomllib

import pytest

from dynabot_mj.controllers import gains
from dynabot_mj.controllers.gains import Gains


@pytest.fixture
def text():
    return gains.path("first").read_text(encoding="utf-8")


def write(tmp_path, text):
    (tmp_path / "set.toml").write_text(text, encoding="utf-8")
    return str(tmp_path / "set.toml")


def test_the_sets_of_the_package_are_whole():
    assert {"first", "tuned"} <= set(gains.names())
    for name in gains.names():
        assert isinstance(gains.load(name), Gains)
        assert tomllib.loads(gains.path(name).read_text(encoding="utf-8"))["provenance"]


def test_what_is_dumped_is_loaded_again(tmp_path):
    found = gains.load("first")
    provenance = {"command": "dynabot tune", "seed": 3, "cost_before": 0.25}
    file = write(tmp_path, gains.dump(found, provenance))
    assert gains.load(file) == found
    assert tomllib.loads((tmp_path / "set.toml").read_text())["provenance"] == provenance


def test_whole_numbers_are_numbers(tmp_path, text):
    loaded = gains.load(write(tmp_path, text.replace("heading_gain = 4.0", "heading_gain = 4")))
    assert loaded == gains.load("first")
    assert isinstance(loaded.heading.heading_gain, float)


def test_a_set_that_is_not_there_is_refused_with_the_list(tmp_path):
    for name in ("absent", str(tmp_path / "absent.toml"), str(tmp_path), ""):
        with pytest.raises(FileNotFoundError) as error:
            gains.load(name)
        assert str(error.value) == (
            f"gains {name!r} given, it must be a gain file or one of: {', '.join(gains.names())}"
        )


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[hand_point]", "[hand]", "must have a table hand_point with just these keys: hold, catch_up, "),
        ("[heading]", "[head]", "must have a table heading with just these keys"),
        ("[traction]", "[grip]", "must have a table traction with just these keys"),
        ("offset = 0.35", "offset = 0.35\nbogus = 1.0", "must have a table hand_point with just these keys"),
        ("offset = 0.35\n", "", "must have a table hand_point with just these keys"),
        ("offset = 0.35", "offset = nan", "hand_point.offset = nan given, it must be a finite number and positive"),
        ("hold = 1.5", "hold = inf", "hand_point.hold = inf given, it must be a finite number and positive"),
        ("offset = 0.35", "offset = 0", "hand_point.offset = 0 given, it must be a finite number and positive"),
        ("offset = 0.35", "offset = '0.35'", "hand_point.offset = 0.35 given, it must be a finite number and positive"),
        ("offset = 0.35", "offset = true", "hand_point.offset = True given, it must be a finite number and positive"),
        (
            "yaw_gain = 2.0",
            "yaw_gain = -2.0",
            "traction.yaw_gain = -2.0 given, it must be a finite number and at least 0",
        ),
        ("offset = 0.35", "offset = ", "cannot be read"),
        ("offset = 0.35", "offset = " + "1" * 400, "1 given, it must be a finite number and positive"),
        ("offset = 0.35", "offset = " + "1" * 5000, "cannot be read"),
        ("offset = 0.35", "offset = 0x" + "1" * 5000, "a number with too many digits given"),
        ("offset = 0.35", "offset = " + "[" * 3000, "cannot be read: brackets are nested too deeply"),
    ],
)
def test_nonsense_is_named_in_one_line(old, new, message, tmp_path, text):
    assert old in text
    file = write(tmp_path, text.replace(old, new))
    with pytest.raises(ValueError) as error:  # noqa: PT011, the message is looked at below
        gains.load(file)
    assert message in str(error.value)
    assert file in str(error.value)
    assert "\n" not in str(error.value)


def test_a_file_that_is_not_text_is_refused(tmp_path):
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(ValueError, match="cannot be read"):
        gains.load(str(tmp_path / "binary.toml"))
