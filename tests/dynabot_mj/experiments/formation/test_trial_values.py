import numpy as np

from dynabot_mj.experiments.formation import trial_values


def test_a_contact_or_an_overturned_body_decides_whichever_comes_first(dataset):
    changed = dataset.copy(deep=True)
    changed.contact[{"case": 1}] = [2.0, np.nan, np.nan]
    changed.overturned[{"case": 1}] = [1.0, 3.0, np.nan]
    np.testing.assert_array_equal(trial_values.failure(changed.isel(case=1)), [1.0, 3.0, np.nan])
