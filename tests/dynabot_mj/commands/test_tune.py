import json

import pytest

from dynabot_mj import cli
from dynabot_mj.controllers import gains


def test_a_tuning_leaves_gains_verdict_and_figures(small_tuning, tmp_path, capsys):
    assert cli.main(["tune", "traction", "--out", str(tmp_path), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["provenance"]["cost_after"] < document["provenance"]["cost_before"]
    assert {"tuning.json", "tuning.md", "tuning.png", "parity.png"} <= {file.name for file in tmp_path.iterdir()}
    adopted = document["provenance"]["adopted"]
    file = tmp_path / ("gains.toml" if adopted else "not_adopted.toml")
    assert gains.load(str(file)).hand_point.offset == document["gains"]["hand_point"]["offset"]
    assert (tmp_path / "gains.toml").exists() == adopted
    assert "adopted" in (tmp_path / "tuning.md").read_text()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--period", "0"], "0.005 to 0.5 s"),
        (["--friction", "9"], "0.05 to 1.5"),
        (["--start", "none"], "one of: first, tuned"),
        (["--model", "nowhere.xml"], "nowhere.xml"),
        (["--courses", "nowhere.toml"], "nowhere.toml"),
        (["--scenario", "nowhere.toml"], "--scenario is called --courses now"),
        (["--seed", "-1"], "negative"),
    ],
)
def test_nonsense_is_refused_before_any_work(arguments, message, tmp_path, capsys):
    assert cli.main(["tune", "traction", "--out", str(tmp_path / "out"), *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()
