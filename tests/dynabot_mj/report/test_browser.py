"""The report in a real browser, without a network."""

import contextlib
import html
import io
import json
import shutil
import subprocess
import urllib.request

import imageio.v3 as imageio
import numpy as np
import pytest

from dynabot_mj import cli, study

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
addEventListener("load", async () => {
  const wrong = [], all = (what) => [...document.querySelectorAll(what)];
  for (const video of all("video"))
    if (video.readyState < 1 && !video.error)
      await new Promise((done) => { video.onloadedmetadata = video.onerror = done; });
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
});
</script>
"""
# A frame, because a window of the browser is not as narrow as a phone. Its title is what the browser tells of it.
FRAME = """<!DOCTYPE html>
<script>addEventListener("message", (event) => document.title = event.data);</script>
<iframe src="{page}" width="{width}" height="900" style="border: 0"></iframe>
"""


@pytest.fixture(scope="module")
def report(dataset, small_report, tmp_path_factory):
    """A report of a small study, as the command writes it, and what it says of it."""
    folder = tmp_path_factory.mktemp("report")
    study.save(dataset, folder / "study.nc")
    with contextlib.redirect_stdout(io.StringIO()) as told:
        assert cli.main(["report", str(folder), "--json"]) == 0
    return folder / "report.html", json.loads(told.getvalue())


@pytest.fixture
def browse(tmp_path):
    """Runs the browser with a profile of its own and returns what it printed."""

    def run(page, *options):
        line = [BROWSER, *FLAGS, f"--user-data-dir={tmp_path / 'profile'}", *options, page.as_uri()]
        return subprocess.run(line, capture_output=True, text=True, timeout=240, check=True)

    return run


@pytest.fixture
def title(polled, tmp_path):
    """Opens a page and returns its title once it is one of ours, JSON: a busy machine only takes longer."""

    def told(page):
        profile = tmp_path / f"profile of {page.stem}"
        line = [BROWSER, *FLAGS, f"--user-data-dir={profile}", "--remote-debugging-port=0", "--window-size=1400,1000"]
        active = profile / "DevToolsActivePort"
        silent = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        with subprocess.Popen([*line, page.as_uri()], **silent) as browser:
            try:
                port = polled(lambda: active.read_text().split("\n")[0] if active.is_file() else "")

                def titles():
                    with urllib.request.urlopen(f"http://127.0.0.1:{port}/json", timeout=240) as answer:
                        found = [html.unescape(one["title"]) for one in json.load(answer) if one["type"] == "page"]
                    return [one for one in found if one.startswith("{")]

                return polled(titles)
            finally:
                browser.kill()

    return told


def console(text):
    return [line for line in text.splitlines() if ":CONSOLE" in line]


def found(title, page, width):
    """Returns what the check found in a page, whose policy has to let the check itself run."""
    text = page.read_text(encoding="utf-8")
    checked, frame = page.with_name("checked.html"), page.with_name("frame.html")
    policy = text.replace("default-src 'none';", "default-src 'none'; script-src 'unsafe-inline';")
    assert policy != text
    checked.write_text(policy.replace("</body>", f"{CHECK}</body>"), encoding="utf-8")
    frame.write_text(FRAME.format(page=checked.name, width=width), encoding="utf-8")
    told = title(frame)
    assert told, "the check did not run"
    return json.loads(told[0])


@pytest.mark.parametrize("width", WIDTHS)
def test_everything_loads_and_fits(title, report, width):
    page, told = report
    seen = found(title, page, width)
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


def test_the_check_sees_what_is_wrong(title, report, tmp_path):
    broken = tmp_path / "broken.html"
    wrong = '<img alt="gone" src="data:image/png;base64,AAAA"><video src="data:video/mp4;base64,AAAA"></video>'
    wide = '<div style="width:2000px"><table id="result"><tr><td>x</td></tr></table></div>'
    text = report[0].read_text(encoding="utf-8")
    broken.write_text(text.replace("<main>", f"<main>{wrong}{wide}"), encoding="utf-8")
    told = " ".join(found(title, broken, 1280)["wrong"])
    for part in ("image gone", "video", "ids clash", "a table without its box", "wider than the window"):
        assert part in told


def test_the_page_may_load_nothing_from_elsewhere(browse, report, tmp_path):
    page = tmp_path / "curious.html"
    text = report[0].read_text(encoding="utf-8")
    page.write_text(text.replace("<main>", '<main><img alt="" src="http://127.0.0.1:9/x.png">'), encoding="utf-8")
    done = browse(page, f"--screenshot={tmp_path / 'page.png'}")
    assert any("Content Security Policy" in line for line in console(done.stderr))
