import numpy as np

from dynabot_mj.study import campaign, dataset, execution, trial_chunks
from dynabot_mj.study.execution import Execution, Watch


def test_shorter_trials_and_smaller_teams_fill_their_part():
    tree = {"trials": 2, "plants": ["particle"], "estimators": ["gps"]}
    made = campaign.load({**tree, "grid": {"zip": {"robots": [2, 3], "duration": [2.0, 1.0]}}}, "grid.toml")
    results = execution.execute(trial_chunks.chunks(made), Execution(), Watch())
    found = dataset.whole(made, results)
    assert (found.sizes["robot"], found.sizes["time"]) == (3, 21)
    few, short = (found.trajectory_w.isel(case=index, recorded=0) for index in range(2))
    assert np.isfinite(few[:, :2]).all()
    assert np.isnan(few[:, 2]).all()
    assert np.isfinite(short[:11]).all()
    assert np.isnan(short[11:]).all()
    np.testing.assert_array_equal(found.isel(case=1).final_position_w, results[1]["final_position_w"])
