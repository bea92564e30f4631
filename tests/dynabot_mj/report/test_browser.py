"""The report in a real browser, without a network."""

import html
import json
import re
import shutil
import subprocess

import imageio.v3 as imageio
import numpy as np
import pytest

from dynabot_mj import study

BROWSER = shutil.which("chromium") or shutil.which("google-chrome")
WIDTHS = (1280, 390)
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--disable-background-networking",
    "--disable-component-update",
    "--no-first-run",
    "--hide-scrollbars",
    "--enable-logging=stderr",
]

pytestmark = pytest.mark.skipif(
    BROWSER is None, reason="no browser: install the system package chromium to see the report tested in one"
)

# Collects what is wrong with a page once it has loaded, and what there is to be wrong.
CHECK = """
<script>
addEventListener("load", () => setTimeout(() => {
  const wrong = [], all = (what) => [...document.querySelectorAll(what)];
  for (const image of all("img")) if (!image.complete || !image.naturalWidth) wrong.push("image " + image.alt);
  for (const video of all("video")) if (video.readyState < 1 || !video.videoWidth) wrong.push("video " + video.error);
  for (const svg of all("svg")) {
    const box = svg.getBoundingClientRect();
    if (box.width < 250 || box.height < 100) wrong.push("figure of " + box.width + " x " + box.height);
  }
  const ids = all("[id]").map((one) => one.id);
  if (new Set(ids).size !== ids.length) wrong.push("ids clash");
  for (const use of all("use")) {
    const name = use.getAttribute("xlink:href").slice(1);
    if (!document.getElementById(name)) wrong.push("nothing is called " + name);
  }
  for (const link of all("nav a")) if (!document.querySelector(link.hash)) wrong.push("no section " + link.hash);
  for (const box of all("table")) if (!box.parentElement.matches(".wide")) wrong.push("a table without its box");
  const excess = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  if (excess > 0) wrong.push("wider than the window by " + excess);
  const found = { figures: all("svg").length, tables: all("table").length, videos: all("video").length, wrong };
  parent.postMessage(JSON.stringify(found), "*");
}, 500));
</script>
"""
# A frame, because a window of the browser is not as narrow as a phone.
FRAME = """<!DOCTYPE html>
<script>addEventListener("message", (event) => document.documentElement.dataset.found = event.data);</script>
<iframe src="{page}" width="{width}" height="900" style="border: 0"></iframe>
"""


@pytest.fixture(scope="module")
def report(dynabot, dataset, tmp_path_factory):
    """A report of a small study, as the command writes it, and what it says of it."""
    folder = tmp_path_factory.mktemp("report")
    study.save(dataset, folder / "study.nc")
    done = dynabot("report", folder, "--json")
    assert done.returncode == 0, done.stderr
    return folder / "report.html", json.loads(done.stdout)


@pytest.fixture
def browse(tmp_path):
    """Runs the browser with a profile of its own and returns what it printed."""

    def run(page, *options):
        line = [BROWSER, *FLAGS, f"--user-data-dir={tmp_path / 'profile'}", *options, page.as_uri()]
        return subprocess.run(line, capture_output=True, text=True, timeout=120, check=True)

    return run


def console(text):
    return [line for line in text.splitlines() if ":CONSOLE" in line]


def found(browse, page, width):
    """Returns what the check found in a page, whose policy has to let the check itself run."""
    text = page.read_text(encoding="utf-8")
    checked, frame = page.with_name("checked.html"), page.with_name("frame.html")
    policy = text.replace("default-src 'none';", "default-src 'none'; script-src 'unsafe-inline';")
    assert policy != text
    checked.write_text(policy.replace("</body>", f"{CHECK}</body>"), encoding="utf-8")
    frame.write_text(FRAME.format(page=checked.name, width=width), encoding="utf-8")
    done = browse(frame, "--window-size=1400,1000", "--virtual-time-budget=10000", "--dump-dom")
    data = re.search(r'data-found="([^"]*)"', done.stdout)
    assert data, "the check did not run"
    return json.loads(html.unescape(data[1]))


@pytest.mark.parametrize("width", WIDTHS)
def test_everything_loads_and_fits(browse, report, width):
    page, told = report
    seen = found(browse, page, width)
    assert seen["wrong"] == []
    assert seen["figures"] >= 10
    assert seen["tables"] >= 4
    assert seen["videos"] == told["film"]


@pytest.mark.parametrize("width", WIDTHS)
def test_it_looks_like_something_and_the_console_is_silent(browse, report, width, tmp_path):
    picture = tmp_path / "page.png"
    done = browse(report[0], f"--window-size={width},3000", f"--screenshot={picture}")
    assert console(done.stderr) == []
    seen = imageio.imread(picture)[..., :3]
    assert seen.shape[1] == width
    for part in np.array_split(seen, 5):  # none of them is blank
        assert len(np.unique(part.reshape(-1, 3), axis=0)) > 20


def test_the_check_sees_what_is_wrong(browse, report, tmp_path):
    broken = tmp_path / "broken.html"
    wrong = '<img alt="gone" src="data:image/png;base64,AAAA"><video src="data:video/mp4;base64,AAAA"></video>'
    wide = '<div style="width:2000px"><table id="result"><tr><td>x</td></tr></table></div>'
    text = report[0].read_text(encoding="utf-8")
    broken.write_text(text.replace("<main>", f"<main>{wrong}{wide}"), encoding="utf-8")
    told = " ".join(found(browse, broken, 1280)["wrong"])
    for part in ("image gone", "video", "ids clash", "a table without its box", "wider than the window"):
        assert part in told


def test_the_page_may_load_nothing_from_elsewhere(browse, report, tmp_path):
    page = tmp_path / "curious.html"
    text = report[0].read_text(encoding="utf-8")
    page.write_text(text.replace("<main>", '<main><img alt="" src="http://127.0.0.1:9/x.png">'), encoding="utf-8")
    done = browse(page, f"--screenshot={tmp_path / 'page.png'}")
    assert any("Content Security Policy" in line for line in console(done.stderr))
