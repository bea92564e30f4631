from dynabot_mj.study import provenance


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
