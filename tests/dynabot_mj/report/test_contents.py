"""Of a study whose trials cannot be repeated; a whole page is told of in test_material, where all of it is gathered."""

import json
import re

import pytest

from dynabot_mj.report import contents
from dynabot_mj.report.contents import Material


@pytest.fixture(scope="module")
def bare(dataset, circled):
    """What there is without recordings and a film."""
    return Material(
        study=dataset,
        execution={},
        recordings=[],
        recordings_note="There are no figures over time: <the gains> have changed.",
        clip=None,
        clip_note="There is no film.",
        circle=circled,
    )


@pytest.fixture(scope="module")
def page(bare):
    return contents.build(bare).html


def test_sections_come_in_the_order_in_which_a_study_is_read(page):
    assert re.findall(r'<h2 id="[^"]+">([^<]+)</h2>', page) == [
        "Result", "Film", "What differs", "Beside the paper", "Distributions", "Paths", "One trial over time",
        "Errors in the loop", "Estimators on a tether", "How it was made",
    ]  # fmt: skip


def test_what_is_not_there_is_told_in_its_place(page):
    assert "There is no film." in page
    assert "<video" not in page
    assert "Distances to the leader" not in page


def test_the_origin_has_what_is_known_of_it(page, dataset):
    for name, digest in json.loads(dataset.attrs["inputs"]).items():
        assert f"digest of the {name}" in page
        assert digest in page
    assert "executed" not in page  # nothing says how
    assert "Made by" not in page
