import numpy as np

from dynabot_mj.experiments.formation import single_trial


def test_a_trial_is_told_without_rates_or_intervals(dataset):
    changed = dataset.isel(trial=slice(1, 2)).copy(deep=True)
    case = changed.isel(case=1)
    case.arrival[0], case.contact[0], case.in_band[0] = 7.25, np.nan, 0.5
    text = single_trial.markdown(case)
    assert "rigid/gauss-markov/gps, trial 1" in text
    told = dict(line.strip("| ").split(" | ")[:2] for line in text.splitlines() if line.count(" | ") == 1)
    cells = {name.strip(): value.strip() for name, value in told.items()}
    assert (cells["arrival"], cells["first contact of hulls"]) == ("7.25 s", "none")
    assert cells["time in the band since arrival"] == "50 %"
    assert "[" not in text
    assert "nan" not in text


def test_a_trial_that_broke_down_is_told_as_such(dataset):
    changed = dataset.copy(deep=True)
    changed.diverged[:] = 1
    assert "diverged" in single_trial.markdown(changed.isel(case=0))
