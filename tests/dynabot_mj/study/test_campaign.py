import numpy as np
import pytest
import xarray as xr

from dynabot_mj import study
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.study import campaign, configuration, dataset, execution, layout, trial_chunks
from dynabot_mj.study.execution import Execution, Watch

BASE = {"trials": 2, "duration": 2.0, "plants": ["particle"], "estimators": ["perfect", "gps"]}


def load(grid, **options):
    return campaign.load({**BASE, "grid": grid}, "grid.toml", **options)


def run(made, **how):
    results = execution.execute(trial_chunks.chunks(made), Execution(**how), Watch())
    return dataset.whole(made, results)


def test_lists_are_crossed_and_zipped_ones_go_together():
    made = load({"robots": [3, 5], "zip": {"duration": [2.0, 3.0], "field": {"spacing": [5.0, 6.0]}}})
    assert [point.values for point in made.points] == [
        {"robots": 3, "duration": 2.0, "field.spacing": 5.0},
        {"robots": 3, "duration": 3.0, "field.spacing": 6.0},
        {"robots": 5, "duration": 2.0, "field.spacing": 5.0},
        {"robots": 5, "duration": 3.0, "field.spacing": 6.0},
    ]
    assert [point.setup.field.spacing for point in made.points] == [5.0, 6.0] * 2
    assert made.entries[1].label == "particle/gauss-markov/gps/robots=3/duration=2.0/spacing=5.0"
    assert len(made.entries) == 8


def test_dotted_keys_may_be_quoted_or_tables():
    assert load({"radio.message_bytes": [40, 50]}).points == load({"radio": {"message_bytes": [40, 50]}}).points


def test_a_short_name_that_would_hide_a_variable_or_be_ambiguous_is_whole():
    made = load(
        {"method.gps.alpha_h": [300.0, 310.0], "method.gps.uncertainty": [3.0], "surrogate.sigma": ["per-axis"]}
    )
    assert made.names == {
        "method.gps.alpha_h": "method.gps.alpha_h",
        "method.gps.uncertainty": "uncertainty",
        "surrogate.sigma": "sigma",
    }
    both = load({"method.gps.uncertainty": [3.0], "method.coupled.uncertainty": [1.0]})
    assert list(both.names.values()) == ["method.gps.uncertainty", "method.coupled.uncertainty"]


def test_the_text_of_a_campaign_is_the_campaign():
    made = load({"robots": [3, 5], "zip": {"radio": {"message_bytes": [40, 50]}}}, trials=1)
    again = campaign.parse(made.text, "its own")
    assert again.entries == made.entries
    assert [point.setup for point in again.points] == [point.setup for point in made.points]


def test_without_a_grid_it_is_a_study():
    made = load({})
    assert made.grid == ""
    assert made.text == configuration.dump(made.first)
    xr.testing.assert_identical(run(made), study.run(configuration.build(BASE)))


def test_each_point_is_the_study_that_it_is_by_itself():
    made = load({"robots": [2, 4], "zip": {"duration": [2.0, 3.0]}})
    whole = run(made)
    parts = dataset.points(whole)
    assert len(parts) == len(made.points) == 4
    for part, point in zip(parts, made.points, strict=True):
        xr.testing.assert_identical(part, study.run(point.setup))


def test_cases_are_selected_by_what_they_differ_in(tmp_path):
    made = load({"robots": [2, 4], "radio.message_bytes": [40, 50]})
    whole = run(made)
    assert whole.sel(robots=4).sizes["case"] == 4
    one = whole.sel(robots=4).sel(message_bytes=50).sel(estimator="gps")
    assert str(one.case.item()) == "particle/gauss-markov/gps/robots=4/message_bytes=50"
    assert np.isnan(whole.sel(robots=2).final_position_w[:, :, 2:]).all()  # robots that are not there
    study.save(whole, tmp_path / "a.nc")
    xr.testing.assert_identical(study.load(tmp_path / "a.nc"), whole)


@pytest.mark.parametrize(
    ("grid", "told"),
    [
        (3, r"grid = 3 given, it must be a table of lists"),
        ({"robots": 3}, r"grid.robots = 3 given, it must be a list"),
        ({"robots": []}, r"grid.robots = \[\] given, it must be a list"),
        ({"robots": [3, 3]}, r"grid.robots = \[3, 3\] given, it has a value twice"),
        ({"robots": [3, 9]}, r"robots = 9: .* \(at robots = 9 of the grid\)"),
        ({"robbots": [3]}, r"unknown key robbots; did you mean robots\? \(at robbots = 3 of the grid\)"),
        ({"trials": [3]}, r"grid.trials given, but all points have the same trials"),
        ({"seed": [3]}, r"grid.seed given, but all points have the same random numbers"),
        ({"estimators": [["gps"]]}, r"grid.estimators given, but a study has several of them without a grid: est"),
        ({"robots": [3], "zip": {"robots": [3]}}, r"grid.robots given, and grid.zip.robots too"),
        ({"zip": {"robots": [3, 4], "duration": [1.0]}}, r"must have one length, but robots has 2, duration has 1"),
        ({"zip": 3}, r"grid.zip = 3 given"),
        ({"robots.a": [3]}, r"grid.robots.a given, but robots is no table"),
        (
            {"start.distance": [float(x) for x in range(30, 130)], "field.width": [x / 100 for x in range(50, 160)]},
            "11000",
        ),
    ],
)
def test_what_is_no_grid_is_told_in_one_line(grid, told):
    with pytest.raises(InputError, match=told) as raised:
        campaign.load({**BASE, "robots": 3, "grid": grid}, "grid.toml")
    assert "\n" not in str(raised.value)


def test_an_option_that_the_grid_sets_is_refused():
    with pytest.raises(InputError, match=r"robots given by an option and by the grid of grid.toml; give it once"):
        load({"robots": [3, 5]}, robots=4)


@pytest.mark.parametrize("grid", [{}, {"robots": [2, 4]}])
def test_the_same_content_is_the_same_bytes_whoever_writes_it(grid, tmp_path):
    made = load(grid)
    results = execution.execute(trial_chunks.chunks(made), Execution(), Watch())
    layout.write(made, results, tmp_path / "chunk_by_chunk.nc")
    study.save(dataset.whole(made, results), tmp_path / "whole.nc")
    study.save(study.load(tmp_path / "whole.nc"), tmp_path / "again.nc")
    one, *others = ((tmp_path / name).read_bytes() for name in ("chunk_by_chunk.nc", "whole.nc", "again.nc"))
    assert all(other == one for other in others)
