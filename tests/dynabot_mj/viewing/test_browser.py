import socket

import pytest

from dynabot_mj.common.exceptions import DynabotError
from dynabot_mj.viewing.playback import Clock

browser = pytest.importorskip(
    "dynabot_mj.viewing.browser", reason="mjviser is missing: pip install 'dynabot-mj[view]'", exc_type=ImportError
)


@pytest.mark.parametrize("host", ["127.0.0.1", "no.such.host.invalid"])
def test_where_it_cannot_be_listened_on_nothing_is_served(host):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(DynabotError, match=f"cannot listen on {host}, port {port}: "):
            browser.Browser(None, Clock(1.0), title="", duration=1.0, host=host, port=port)
