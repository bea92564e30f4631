import argparse

import pytest

from dynabot_mj.commands import parsers, setups
from dynabot_mj.common.exceptions import InputError


def parsed(*line):
    return argparse.ArgumentParser(parents=[parsers.study()]).parse_args(list(line))


def test_options_stand_above_the_file_and_the_file_above_the_defaults(tmp_path):
    (tmp_path / "study.toml").write_text("trials = 7\nseed = 3\n[vehicle]\npayload = 2.0\n")
    options = parsed("--config", str(tmp_path / "study.toml"), "--seed", "4")
    setup = setups.build(options, {"trials": 3, "estimators": ["gps"]})
    assert (setup.trials, setup.seed, setup.vehicle.payload, setup.estimators) == (7, 4, 2.0, ("gps",))


def test_options_that_do_nothing_are_refused_and_keys_of_a_file_are_told(tmp_path, capsys):
    with pytest.raises(InputError, match="--friction given, but the study has point masses alone"):
        setups.build(parsed("--friction", "0.5"), plants=["particle"])
    (tmp_path / "study.toml").write_text("plants = ['particle']\n[vehicle]\nfriction = 0.5\ngains = 'first'\n")
    setups.build(parsed("--config", str(tmp_path / "study.toml")))
    told = capsys.readouterr().err
    assert told.startswith(f"note: vehicle.friction, vehicle.gains in {tmp_path / 'study.toml'}: no effect, since ")
    assert told.count("\n") == 1
