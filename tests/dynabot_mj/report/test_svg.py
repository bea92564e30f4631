import re

import matplotlib.pyplot as plt
import pytest

from dynabot_mj.report import svg


def draw():
    figure, axis = plt.subplots(figsize=(4.0, 2.0))
    axis.plot([0.0, 1.0, 2.0], [0.0, 1.23456789, 0.5], "o-", label="line")
    axis.legend()
    return figure


@pytest.fixture
def pair():
    return svg.inline(draw(), "one", "told"), svg.inline(draw(), "two", "told")


def test_ids_of_two_figures_do_not_clash_and_every_reference_is_met(pair):
    ids = [re.findall(r'\bid="([^"]+)"', text) for text in pair]
    assert ids[0]
    assert not set(ids[0]) & set(ids[1])
    for text, own in zip(pair, ids, strict=True):
        assert len(own) == len(set(own))
        assert set(re.findall(r'href="#([^"]+)"|url\(#([^)]+)\)', text)) <= {(one, "") for one in own} | {
            ("", one) for one in own
        }


def test_the_same_figure_is_the_same_text(pair):
    assert svg.inline(draw(), "one", "told") == pair[0]


def test_nothing_reaches_beyond_the_figure(pair):
    assert pair[0].startswith("<svg role")
    assert not re.search(r"<style|<metadata|<\?xml|<!DOCTYPE|<!--", pair[0])


def test_what_it_shows_is_told_in_an_attribute():
    assert 'aria-label="a &lt; b &quot;c&quot; &amp; d"' in svg.inline(draw(), "one", 'a < b "c" & d')


def test_paths_have_hundredths_and_the_figure_its_natural_size(pair):
    paths = re.findall(r' d="([^"]+)"', pair[0])
    assert not any(re.search(r"\.\d{3}", path) or "\n" in path for path in paths)
    assert "width:384px;min-width:276px;aspect-ratio:384/192" in pair[0]


def test_drawing_leaves_no_figure_open():
    before = plt.get_fignums()
    svg.inline(draw(), "one", "told")
    assert plt.get_fignums() == before
