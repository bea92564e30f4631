import json

import numpy as np
import pytest

from dynabot_mj.common import intervals
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.experiments.formation import case_rows, grid
from dynabot_mj.study import campaign, dataset, execution, trial_chunks
from dynabot_mj.study.execution import Execution, Watch


def of(study, label):
    return study.sel(case=label)


def test_rows_are_those_of_each_point(gridded, grid_study):
    found = grid.found(grid_study, gridded)
    assert [row.label for row in found.rows] == [entry.label for entry in gridded.entries]
    assert found.factors == ["robots", "correlation_time"]
    part = dataset.points(grid_study)[3]
    assert [one.row for one in found.rows[6:]] == case_rows.rows(part)
    assert found.rows[6].values == {"robots": 3, "correlation_time": 3.0}


def test_cases_are_compared_with_those_at_the_first_value_of_one_key(gridded, grid_study):
    found = grid.found(grid_study, gridded)
    pairs = list(dict.fromkeys((one.a, one.b, one.factor) for one in found.paired))
    assert len(pairs) == 8  # 2 estimators x 2 values of the other key, for each of two keys
    first = "particle/gauss-markov/decoupled/robots=2/correlation_time=0.3"
    assert ("particle/gauss-markov/decoupled/robots=3/correlation_time=0.3", first, "robots") in pairs
    assert ("particle/gauss-markov/decoupled/robots=2/correlation_time=3.0", first, "correlation_time") in pairs
    # Holm's adjustment is over all of one factor.
    for factor in found.factors:
        family = [one for one in found.paired if one.factor == factor]
        assert [one.p_holm for one in family] == intervals.holm([one.p for one in family])


def test_a_difference_is_that_of_the_trials(gridded, grid_study):
    a, b = "particle/gauss-markov/coupled/robots=2/correlation_time=3.0", "particle/gauss-markov/decoupled/robots=3/"
    b += "correlation_time=0.3"
    found = grid.found(grid_study, gridded, pairs=[(a, b)])
    (one,) = (one for one in found.paired if one.metric == "arrival_s")
    difference = (of(grid_study, a).arrival - of(grid_study, b).arrival).values
    assert one.factor == "several"
    assert one.difference == pytest.approx(np.nanmean(difference))
    assert one.n == np.isfinite(difference).sum()


def test_measures_that_a_duration_cuts_off_are_not_compared_where_durations_differ():
    tree = {"trials": 3, "plants": ["particle"], "estimators": ["perfect"], "grid": {"duration": [14.0, 15.0]}}
    other = campaign.load(tree, "grid.toml")
    whole = dataset.whole(other, execution.execute(trial_chunks.chunks(other), Execution(), Watch()))
    told = {one.metric: one.difference for one in grid.found(whole, other).paired}
    assert told["time_to_formation_s"] is None
    assert told["completion_common"] is not None


def test_the_document_is_json_without_nan(gridded, grid_study):
    document = json.loads(json.dumps(grid.document(grid.found(grid_study, gridded)), allow_nan=False))
    assert document["rows"][0]["values"] == {"robots": 2, "correlation_time": 0.3}
    assert document["rows"][0]["estimator"] == "decoupled"


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"over": ["robot"]}, "--over robot given, it must be one of robots, .*; did you mean robots"),
        ({"over": ["robots", "robots"]}, "it must be one factor or two"),
        ({"over": ["robots", "correlation_time", "plant"]}, "it must be one factor or two"),
        ({"shown": ["arrival"]}, "--measures arrival given, it must be of arrival_s, .*; did you mean arrival_s"),
        ({"pairs": [("a", "b")]}, "--pair a given, the study has: particle/"),
        ({"pairs": [["particle/gauss-markov/decoupled/robots=2/correlation_time=0.3"] * 2]}, "must be two cases"),
    ],
)
def test_what_there_is_not_is_told(gridded, options, told):
    with pytest.raises(InputError, match=told):
        grid.check(gridded, **{"over": None, "shown": grid.SHOWN, "pairs": [], **options})
