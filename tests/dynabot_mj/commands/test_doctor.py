import json

import pytest

from dynabot_mj import cli
from dynabot_mj.host import doctor
from dynabot_mj.host.doctor import Check

GOOD = Check(name="mujoco", ok=True, found="3.17.0", needed=True)
BAD = Check(name="drawing", ok=False, found="no OpenGL back end", needed=True, mend="apt-get install libegl1")


@pytest.mark.parametrize(("checks", "code"), [([GOOD], 0), ([GOOD, BAD], 1)])
def test_exit_code_and_one_line(monkeypatch, capsys, checks, code):
    monkeypatch.setattr(doctor, "examine", lambda cores, figures_asked: checks)
    assert cli.main(["doctor"]) == code
    out, err = capsys.readouterr()
    assert "| mujoco" in out
    assert err == ("dynabot: drawing: no OpenGL back end; to mend it: apt-get install libegl1\n" if code else "")


def test_json(monkeypatch, capsys):
    monkeypatch.setattr(doctor, "examine", lambda cores, figures_asked: [GOOD, BAD])
    assert cli.main(["doctor", "--json"]) == 1
    assert json.loads(capsys.readouterr().out) == doctor.document([GOOD, BAD])
