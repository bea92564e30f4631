import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.controllers import gains
from dynabot_mj.study import configuration, provenance


def test_the_digest_covers_every_room_the_leaves_the_models_the_gains_and_the_fitted_errors():
    names = {"/".join(file.parts[-3:]) for file in provenance.sources()}
    for name in (
        "dynabot_mj/trial/loop.py",
        "dynabot_mj/testbed/radio.py",
        "dynabot_mj/models/dynabot.xml",
        "dynabot_mj/estimation/kalman.py",
        "controllers/gains/tuned.toml",
        "dynabot_mj/perception/fitted.toml",
    ):
        assert name in names


def test_inputs_change_with_what_is_in_the_files(tmp_path):
    file = tmp_path / "mine.toml"
    text = gains.path("first").read_text(encoding="utf-8")
    file.write_text(text, encoding="utf-8")
    setup = configuration.build({}, gains=str(file))
    before = provenance.inputs(setup)
    assert before == provenance.inputs(configuration.build({}, gains="first"))
    file.write_text(text + "# a remark\n", encoding="utf-8")
    after = provenance.inputs(setup)
    assert after["model"] == before["model"]
    assert after["gains"] != before["gains"]
    file.unlink()
    with pytest.raises(InputError, match="must be a gain file or one of"):
        provenance.inputs(setup)
