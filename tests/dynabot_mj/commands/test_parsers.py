import argparse
from pathlib import Path

import pytest

from dynabot_mj.commands import parsers
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.plants import scene


def test_a_function_is_registered_by_its_name_with_its_docstring_as_help():
    def paint(options):
        """Paints something."""

    parser = argparse.ArgumentParser()
    added = parsers.command(parser.add_subparsers(), paint, parsers.shared())
    assert added.description == "Paints something."
    options = parser.parse_args(["paint", "--json"])
    assert (options.function, options.json) == (paint, True)


def test_friction_is_a_number_or_a_range():
    parser = parsers.science()
    assert parser.parse_args(["--friction", "0.75"]).friction == 0.75
    assert parser.parse_args(["--friction", "0.3..0.9"]).friction == [0.3, 0.9]
    assert parser.parse_args([]).friction is None
    with pytest.raises(SystemExit):
        parser.parse_args(["--friction", "0.3..0.5..0.9"])


def test_options_are_the_conditions_of_a_vehicle():
    parser = parsers.vehicle()
    assert parsers.conditions(parser.parse_args([])) == scene.NOMINAL
    options = parser.parse_args(["--friction", "0.4", "--payload", "2", "--out", "here"])
    assert parsers.conditions(options) == scene.Conditions(friction=0.4, payload=2.0)
    assert (options.out, options.overwrite) == (Path("here"), False)
    with pytest.raises(InputError, match="--payload 101 given, allowed are 0 to 100 kg"):
        parsers.conditions(parser.parse_args(["--payload", "101"]))


def test_an_option_of_another_name_answers_with_that_name():
    parser = argparse.ArgumentParser()
    parsers.renamed(parser, "--old", "--new")
    assert "--old" not in parser.format_help()
    for line in (["--old"], ["--old", "value"]):
        with pytest.raises(InputError, match="--old is called --new now"):
            parser.parse_args(line)
