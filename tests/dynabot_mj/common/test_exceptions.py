import pytest
from pydantic import TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass

from dynabot_mj.common.exceptions import InputError, one_line, suggestion
from dynabot_mj.common.validation import STRICT, Positive, Share


@dataclass(frozen=True, kw_only=True, config=STRICT)
class Inner:
    share: Share = 1.0
    duration: Positive | tuple[Positive, Positive] = 1.0


@dataclass(frozen=True, kw_only=True, config=STRICT)
class Outer:
    trials: int = 1
    inner: Inner = Inner()


def told(text, **options):
    with pytest.raises(ValidationError) as caught:
        TypeAdapter(Outer).validate_json(text)
    return one_line(caught.value, **options)


def test_a_message_is_one_line_whatever_is_in_it():
    assert str(InputError("no model a\nb\x1b é")) == "no model a\\nb\\x1b é"


def test_a_near_name_is_suggested_and_a_far_one_is_not():
    assert suggestion("decopled", ["gps", "decoupled", "coupled"]) == "; did you mean decoupled?"
    assert suggestion("x", ["gps", "decoupled"]) == ""


def test_findings_are_joined_in_one_line_each_with_key_and_value():
    lines = told('{"trials": "many", "inner": {"share": -1.0}}').split("; ")
    assert sorted(lines) == [
        "inner.share = -1: input should be greater than or equal to 0",
        "trials = 'many': input should be a valid integer",
    ]


def test_what_was_typed_stands_in_place_of_the_key_and_a_bound_has_its_unit():
    text = '{"inner": {"duration": -2.5}}'
    found = told(text, typed={"inner.duration": "--duration"}, units={"duration": "s"})
    # One finding of the union, not one for each of its branches.
    assert found == "--duration -2.5: input should be greater than 0 s"


def test_percent_given_for_a_fraction_and_misspelt_keys_are_seen_through():
    assert told('{"inner": {"share": 95.0}}').endswith("; a fraction is meant: 0.95?")
    found = told('{"inner": {"shar": 1.0}}', allowed=["trials", "inner.share"])
    assert found == "unknown key inner.shar; did you mean inner.share?"
