import numpy as np

from dynabot_mj.experiments.formation import measures


def test_every_measure_has_a_value_per_trial_of_a_short_study(dataset):
    for index in range(dataset.sizes["case"]):
        case = dataset.isel(case=index)
        for one in measures.MEASURES:
            values = one.values(case)
            assert values.shape == (3,)
            if one.rate:
                assert np.isin(values[np.isfinite(values)], (0.0, 1.0)).all()


def test_names_are_unique_and_only_tested_ones_compare_plants():
    names = [one.name for one in measures.MEASURES]
    assert len(set(names)) == len(names)
    assert all(one.factors == measures.FACTORS for one in measures.TESTED)


def test_a_contact_or_an_overturned_body_decides_whichever_comes_first(dataset):
    changed = dataset.copy(deep=True)
    changed.contact[{"case": 1}] = [2.0, np.nan, np.nan]
    changed.overturned[{"case": 1}] = [1.0, 3.0, np.nan]
    np.testing.assert_array_equal(measures.failure(changed.isel(case=1)), [1.0, 3.0, np.nan])
