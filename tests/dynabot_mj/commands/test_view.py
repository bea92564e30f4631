import json
import os
import shutil
import signal
import socket
import subprocess
import urllib.parse
import urllib.request

import pytest

OPTIONS = ["--plant", "rigid", "--estimator", "gps", "--duration", "1", "--browser", "--port", "0"]


@pytest.fixture
def serve(command):
    """Starts the command, and returns its process and the address that it prints."""
    pytest.importorskip("mjviser", reason="mjviser is missing: pip install 'dynabot-mj[view]'")
    started = []

    def start(*options):
        line = [command, "view", *map(str, options)]
        process = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        started.append(process)
        told = process.stdout.readline()
        assert "http://" in told, process.communicate(timeout=240)
        return process, told.split(": ")[1].split()[0]

    yield start
    for process in started:
        process.kill()
        # Closes the pipes too: what is left open would surface as a warning in some later test.
        process.communicate()


def interrupt(process):
    process.send_signal(signal.SIGINT)
    return process.communicate(timeout=240)


@pytest.mark.parametrize("how", [[], ["--live"], ["--plant", "particle", "--estimator", "perfect"]])
def test_the_page_comes_to_this_machine_alone_and_ends_with_ctrl_c(serve, how):
    import viser
    from websockets.sync.client import connect

    process, address = serve(*OPTIONS, *how)
    with urllib.request.urlopen(address, timeout=240) as answer:
        assert "viser" in answer.read().decode().lower()
    parts = urllib.parse.urlsplit(address)
    assert parts.hostname == "127.0.0.1"
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.2", parts.port), timeout=10)  # of this machine, but not what was bound
    protocol = f"viser-v{viser.__version__}"
    with connect(f"ws://{parts.netloc}", subprotocols=[protocol], compression=None, max_size=None) as link:
        assert len(link.recv(timeout=240)) > 0
    out, err = interrupt(process)
    assert process.returncode == 0
    assert (out, err) == ("", "")  # the one line with the address was all


@pytest.mark.skipif(shutil.which("chromium") is None, reason="chromium is missing: apt install chromium")
def test_a_browser_draws_the_page(serve, polled, tmp_path):
    from websockets.sync.client import connect

    process, address = serve(*OPTIONS)
    browser = ["chromium", "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path}"]
    browser += ["--enable-unsafe-swiftshader", "--remote-debugging-port=0", address]
    told = tmp_path / "DevToolsActivePort"
    with subprocess.Popen(browser, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as drawn:
        try:
            port = polled(lambda: told.read_text().split("\n")[0] if told.is_file() else "")

            def pages():
                with urllib.request.urlopen(f"http://127.0.0.1:{port}/json", timeout=240) as answer:
                    return [one for one in json.load(answer) if one["url"].startswith(address)]

            (page,) = polled(pages)
            with connect(page["webSocketDebuggerUrl"], max_size=None) as link:

                def document():
                    asked = {"expression": "document.documentElement.outerHTML", "returnByValue": True}
                    link.send(json.dumps({"id": 1, "method": "Runtime.evaluate", "params": asked}))
                    answer = json.loads(link.recv(timeout=240))
                    # Of a page that is only being opened there is no document yet.
                    return answer.get("result", {}).get("result", {}).get("value", "")

                # The name of the trial comes over the page's own websocket.
                wanted = ("rigid/gauss-markov/gps, trial 0", "<canvas")
                shown = polled(document, lambda text: all(one in text for one in wanted))
        finally:
            drawn.kill()
    assert [one for one in wanted if one not in shown] == []
    interrupt(process)


def test_all_may_look_where_the_host_says_so(serve):
    process, address = serve(*OPTIONS, "--host", "0.0.0.0")
    port = urllib.parse.urlsplit(address).port
    socket.create_connection(("127.0.0.2", port), timeout=10).close()
    interrupt(process)


def test_a_port_that_is_taken_is_told(command):
    pytest.importorskip("mjviser", reason="mjviser is missing: pip install 'dynabot-mj[view]'")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        line = [command, "view", *OPTIONS, "--port", str(port)]
        done = subprocess.run(line, capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 1
    assert done.stderr == f"dynabot: cannot listen on 127.0.0.1, port {port}: Address already in use\n"


def test_without_a_display_and_without_the_extra_the_extra_is_named(command, tmp_path):
    (tmp_path / "mjviser.py").write_text("raise ImportError")
    missing = {"PYTHONPATH": str(tmp_path), "DISPLAY": "", "WAYLAND_DISPLAY": ""}
    line = [command, "view", "--duration", "1"]
    done = subprocess.run(line, capture_output=True, text=True, timeout=240, check=False, env={**os.environ, **missing})
    assert done.returncode == 1
    assert done.stderr == "dynabot: the browser needs mjviser: pip install 'dynabot-mj[view]'\n"


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--speed", "0"], "--speed 0 given, allowed are 0.05 to 100"),
        (["--port", "70000"], "--port 70000 given, allowed are 0 to 65535"),
    ],
)
def test_bad_input_is_told_in_one_line(main, options, told):
    done = main("view", *options)
    assert (done.returncode, done.stderr) == (2, f"dynabot: {told}\n")
