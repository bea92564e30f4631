import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.study import configuration, scenario


def test_toml_gives_the_same_scenario_back():
    setup = configuration.build({"robots": 5, "method": {"gps": {"alpha_h": 310.0}}}, seed=7, utilisation=0.95)
    assert configuration.load(configuration.dump(setup), "text") == setup


def test_precedence_is_defaults_then_file_then_options():
    text = "trials = 7\nseed = 3\n[method.gps]\nalpha_h = 310\n[start]\ndistance = 40.0"
    setup = configuration.load(text, "study.toml", seed=4, headings="leader", duration=None)
    assert (setup.trials, setup.seed, scenario.duration(setup)) == (7, 4, 80.0)
    assert (setup.method["gps"].alpha_h, setup.method["gps"].alpha_d) == (310.0, 150.0)
    assert (setup.start.distance, setup.start.headings) == (40.0, "leader")


def test_faults_survive_their_toml():
    faults = [
        {"kind": "outage", "start": 1.0, "end": 2.0, "robots": [0]},
        {"kind": "nan", "channel": "gyro"},
        {"kind": "jump", "size": 15.0},
    ]
    setup = configuration.build({"perception": ["filter"], "sensors": {"faults": faults}})
    assert configuration.load(configuration.dump(setup), "its own") == setup


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("bogus = 1", "unknown key bogus"),
        ("[field]\nmass = 1", "unknown key field.mass"),
        ("mass = -1", "mass = -1: input should be greater than 0"),
        ("trials = '3'", "trials = '3': input should be a valid integer"),
        ("trials = 0", "greater than or equal to 1"),
        ("robots = 9", "robots = 9: input should be less than or equal to 7"),
        ("robots = 0", "robots = 0"),
        ("duration = nan", "duration = nan"),
        ("duration = inf", "duration = inf"),
        (
            "estimators = ['foo']",
            "estimators = 'foo' given, it must be one of perfect, gps, decoupled, coupled, or a method of your own",
        ),
        ("plants = []", "at least 1 item"),
        ("field = 3", "field = 3"),
        ("method = 3", "method = 3"),
        ("[method.gps]\nforce_limit = nan", "method.gps.force_limit = nan"),
        ("[method.gps]\nsample_period = 0.0305", "whole number of timer ticks"),
        ("[processor]\nutilisation = 1.7", "utilisation = 1.7"),
        ("trials = ", "study.toml is not TOML"),
        ("[method.gps]\ncontrol_period = -1", "method.gps.control_period = -1: input should be greater than 0"),
        ("[method.gps]\ncontrl_period = 1", "unknown key method.gps.contrl_period"),
        ("config_x = 3", "unknown key config_x"),
        ("[sensors.gps]\nlatency = 150.0", "sensors.gps.latency = 150: input should be less than or equal to 0.5 s"),
        ('duration = "long"', "duration = 'long'"),
        ("[vehicle]\nfriction = 0.01", "vehicle.friction = 0.01: input should be greater than or equal to 0.05"),
        ("[vehicle]\nfriction = 2.0", "vehicle.friction = 2: input should be less than or equal to 1.5"),
        ("[vehicle]\nfriction = nan", "vehicle.friction = nan"),
        ("[vehicle]\nfriction = 'ice'", "vehicle.friction = 'ice'"),
        ("[vehicle]\nfriction = [0.3, 2.0]", "vehicle.friction = "),
        ("[vehicle]\nfriction = [0.3]", "vehicle.friction = "),
        ("[vehicle]\nslope = 0.6", "vehicle.slope = 0.6: input should be less than or equal to 0.5"),
        ("[vehicle]\nslope = nan", "vehicle.slope = nan"),
        ("[vehicle]\npayload = -1.0", "vehicle.payload = -1: input should be greater than or equal to 0 kg"),
        ("[vehicle]\npayload = inf", "vehicle.payload = inf"),
        ("[vehicle]\nsteering = 'bogus'", "vehicle.steering = 'bogus': input should be 'hand-point' or 'heading'"),
        ("[vehicle]\nsensing = 'bogus'", "vehicle.sensing = 'bogus': input should be 'on-board' or 'truth'"),
        ("[vehicle]\nbogus = 1", "unknown key vehicle.bogus"),
        ("vehicle = 3", "vehicle = 3"),
        ("[sensors.gps]\nperiod = 1e-10", "sensors.gps.period = 1e-10: input should be greater than or equal to 0.01"),
        ("[filter]\nalignment = 1e7", "filter.alignment = 1e+07: input should be less than or equal to 600 s"),
        ("robots = " + "1" * 5000, "study.toml is no configuration: a number has too many digits"),
        ("robots = 0x" + "f" * 5000, "study.toml is no configuration: a number has too many digits"),
        ("mass = " + "1" * 400, "mass = 1.11111e+399"),
        ("a." * 3000 + "a = 1", "study.toml is no configuration: tables are nested too deeply"),
        ("a." * 300 + "a = 1", "study.toml is no configuration: recursion limit exceeded"),
        ('estimators = ["a\\nb"]', "a method of your own, [method.a\\nb]"),
        ('[radio]\n"a b" = 1', "unknown key 'a b' in radio"),
        (f"[vehicle]\nmodel = '{'x' * 300}'", "it must be 'dynabot' or an MJCF file"),
        (f"[vehicle]\ngains = '{'x' * 300}'", "it must be a gain file or one of: first, tuned"),
    ],
)
def test_nonsense_is_named_in_one_line(text, message):
    with pytest.raises(InputError) as error:
        configuration.load(text, "study.toml")
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_files_that_cannot_be_read(tmp_path):
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(InputError, match="not a text file"):
        configuration.load_file(binary)
    with pytest.raises(InputError, match="No such file"):
        configuration.load_file(tmp_path / "absent.toml")


def test_the_callers_defaults_stand_below_the_text():
    setup = configuration.load("trials = 7", "text", {"trials": 3, "plants": ["particle"]}, estimators=["gps"])
    assert (setup.trials, setup.plants, setup.estimators) == (7, ("particle",), ("gps",))


def test_the_vehicles_table_comes_from_the_file_and_the_options():
    text = "[vehicle]\nfriction = [0.3, 0.9]\nslope = 0.1\npayload = 2\nsteering = 'heading'\ngains = 'first'"
    vehicle = configuration.load(text, "study.toml").vehicle
    assert (vehicle.friction, vehicle.slope, vehicle.payload) == ((0.3, 0.9), 0.1, 2.0)
    assert (vehicle.steering, vehicle.gains, vehicle.sensing) == ("heading", "first", "on-board")
    other = configuration.load(text, "study.toml", friction=1, slope=-0.2, sensing="truth").vehicle
    assert (other.friction, other.slope, other.sensing) == (1.0, -0.2, "truth")
    assert isinstance(other.friction, float)
    assert (other.payload, other.steering) == (vehicle.payload, vehicle.steering)


@pytest.mark.parametrize("friction", ["model", 0.4, [0.3, 0.9]])
def test_every_kind_of_friction_survives_the_way_through_toml(friction):
    setup = configuration.build({}, friction=friction, payload=1.5, gains="first")
    assert configuration.load(configuration.dump(setup), "text") == setup
