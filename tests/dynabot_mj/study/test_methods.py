import math

import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.perception.methods import METHODS
from dynabot_mj.study import configuration
from dynabot_mj.study.methods import BUILT_IN, filter_of

MINE = "\n".join(
    ["[method.mine]", "filter = 'filters_of_a_user:Mine'", "uncertainty = 1.2", "estimation_time = 0.004\n"]
)


@pytest.fixture
def module(tmp_path, monkeypatch):
    (tmp_path / "filters_of_a_user.py").write_text(
        "from dynabot_mj.estimation.gps_extrapolation import GpsExtrapolation as Mine\n\n\nclass Little:\n    pass\n"
    )
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)


def load(text, **typed):
    return configuration.load(text, "mine.toml", **typed)


@pytest.mark.parametrize(
    ("name", "alpha_h", "alpha_d", "uncertainty", "estimation_time"),
    [
        ("perfect", 650.0, 300.0, 0.0, 0.0),
        ("gps", 300.0, 150.0, 3.5, 5.9e-3),
        ("decoupled", 650.0, 300.0, 1.1, 13.8e-3),
        ("coupled", 500.0, 300.0, 0.7, 114.2e-3),
    ],
)
def test_rows_have_the_gains_of_table_iii_and_the_errors_and_times_of_table_ii(
    name, alpha_h, alpha_d, uncertainty, estimation_time
):
    row = BUILT_IN[name]
    assert (row.alpha_h, row.alpha_d, row.uncertainty) == (alpha_h, alpha_d, uncertainty)
    assert row.estimation_time == estimation_time


def test_perfect_information_alone_has_a_period_of_its_own_and_no_limit():
    assert (BUILT_IN["perfect"].sample_period, BUILT_IN["perfect"].force_limit) == (0.01, math.inf)
    for name in ("gps", "decoupled", "coupled"):
        row = BUILT_IN[name]
        assert (row.sample_period, row.control_period, row.force_limit) == ("auto", "auto", 50.0)


def test_the_users_method_stands_behind_the_papers_with_the_gains_of_the_decoupled_row(module):
    setup = load(MINE)
    assert list(setup.method) == [*METHODS, "mine"]
    assert setup.estimators == tuple(METHODS)  # it is run where it is asked for
    mine, decoupled = setup.method["mine"], BUILT_IN["decoupled"]
    assert (mine.alpha_h, mine.alpha_d, mine.force_limit) == (decoupled.alpha_h, decoupled.alpha_d, 50.0)
    assert filter_of(setup.method, "mine") == "filters_of_a_user:Mine"
    assert filter_of(setup.method, "coupled") is filter_of(None, "coupled") is None


def test_a_saved_configuration_has_it_too(module):
    setup = load(MINE, estimators=["mine"])
    assert load(configuration.dump(setup)) == setup


def test_one_gain_of_a_built_in_row_leaves_its_others(module):
    setup = load("[method.gps]\nalpha_h = 400.0\n")
    assert (setup.method["gps"].alpha_h, setup.method["gps"].alpha_d) == (400.0, 150.0)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[method.gps]\nfilter = 'a:B'\n", "method.gps.filter = 'a:B' given, but gps is built in; give yours its own"),
        (MINE.replace("mine", "my-own"), r"\[method\.my-own\] given, a method's name has letters, digits and _ alone"),
        (MINE.replace("filter =", "# filter ="), r"\[method\.mine\] given without a filter, it must have one"),
        (MINE.replace("estimation_time", "# "), "method.mine.estimation_time is missing, it must be given"),
        (MINE.replace(":Mine", ":None_"), "method.mine.filter = 'filters_of_a_user:None_' given: .* has no attribute"),
        (
            MINE.replace(":Mine", ":Little"),
            "it has no begin, predict, see_heading, see_fix, .*: see docs/own-estimator",
        ),
        (MINE.replace("filters_of_a_user", "no_such_module"), "cannot be imported: ModuleNotFoundError"),
        (MINE + "alpha = 3.0\n", "unknown key method.mine.alpha"),
    ],
)
def test_a_mistake_is_told_in_one_line(module, text, told):
    with pytest.raises(InputError, match=told) as raised:
        load(text, estimators=[text.partition("[method.")[2].partition("]")[0]])  # those that are not run are not asked
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("text", "options", "told"),
    [
        ("", {"estimators": ["mime"]}, "'mime' given, it must be one of .*; did you mean mine"),
        ("", {"estimators": ["mine"], "perception": ["fitted"]}, "nobody has fitted"),
        (
            "[filter]\nimplementation = 'filterpy'\n",
            {"estimators": ["mine"], "perception": ["filter"]},
            "filter.implementation = 'filterpy' given with mine",
        ),
    ],
)
def test_what_there_is_not_for_it_is_refused(module, text, options, told):
    with pytest.raises(InputError, match=told):
        load(MINE + text, **options)
