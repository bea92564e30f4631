import base64
import re

from dynabot_mj.common.tables import Table
from dynabot_mj.report import page
from dynabot_mj.report.page import Section


def test_the_contents_list_every_section_and_nothing_may_be_loaded():
    sections = [Section(title="The first", parts=["<p>one</p>"]), Section(title="What's next?", parts=[])]
    text = page.html("A & B", "<p>about</p>", sections, "<p>end</p>")
    assert "<title>A &amp; B</title>" in text
    assert re.findall(r'href="#([^"]+)"', text) == re.findall(r'<h2 id="([^"]+)"', text) == ["the-first", "what-s-next"]
    policy = re.search(r'Content-Security-Policy" content="([^"]+)"', text)[1]
    assert policy.startswith("default-src 'none'")
    assert "script" not in policy
    assert not re.search(r"https?://(?!www\.w3\.org/)", text)


def test_tables_are_escaped_and_repeat_what_a_row_belongs_to():
    shown = Table(title="", header=["a", "b<"], body=[["x", "1"], ["", "<2>"]], note="first\npart\n\nsecond")
    text = page.table(shown)
    assert '<th scope="col">b&lt;</th>' in text
    assert '<tr><td class="again">x</td><td>&lt;2&gt;</td></tr>' in text
    assert "<p>first part</p>\n<p>second</p>" in text


def test_downloads_carry_their_files():
    link = re.search(r'download="a.csv" href="data:text/csv;base64,([^"]+)"', page.downloads({"a.csv": "σ,1\n"}))
    assert base64.b64decode(link[1]).decode() == "σ,1\n"


def test_films_are_inside_the_page():
    assert f"data:video/mp4;base64,{base64.b64encode(b'mp4').decode()}" in page.film(b"mp4", "told")


def test_long_texts_are_collapsed_and_escaped():
    assert page.collapsed("t", "a < b").startswith("<details>")
    assert "a &lt; b" in page.collapsed("t", "a < b")
