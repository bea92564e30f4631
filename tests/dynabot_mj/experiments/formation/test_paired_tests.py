import numpy as np
import pytest
import xarray as xr

from dynabot_mj.common import intervals
from dynabot_mj.experiments.formation import measures, paired_tests

MEASURED = tuple(paired_tests.margins(80.0))


def many(study_, times):
    """The trials of a study several times over."""
    repeated = xr.concat([study_] * times, "trial", data_vars="minimal")
    return repeated.assign_coords(trial=np.arange(repeated.sizes["trial"]))


def test_cases_are_paired_that_differ_in_one_factor_and_perfect_is_no_choice(perceptions):
    pairs = {(one.factor, one.a, one.b) for one in paired_tests.paired(perceptions)}
    # Of each estimator with errors: three pairs of plants, three of perceptions on each plant; one of estimators for
    # each plant and perception.
    assert sum(factor == "plant" for factor, *_ in pairs) == 1 + 2 * 3
    assert sum(factor == "perception" for factor, *_ in pairs) == 2 * 2 * 3
    assert sum(factor == "estimator" for factor, *_ in pairs) == 2 * 3
    assert ("plant", "particle/perfect", "rigid/perfect") in pairs
    assert ("perception", "rigid/gauss-markov/gps", "rigid/filter/gps") in pairs
    assert ("estimator", "rigid/filter/gps", "rigid/filter/decoupled") in pairs


def test_differences_are_of_the_same_trials_particle_minus_rigid(dataset):
    found = {one.metric: one for one in paired_tests.paired(dataset)}
    assert set(found) == {one.name for one in measures.PAIRED}
    speed = found["top_speed_mps"]
    assert (speed.a, speed.b) == ("particle/gauss-markov/gps", "rigid/gauss-markov/gps")
    assert speed.difference == pytest.approx(float((dataset.top_speed[0] - dataset.top_speed[1]).mean()))
    assert (speed.n, speed.low, speed.high) == (3, None, None)  # too few for an interval


def test_nothing_is_concluded_from_the_papers_own_measures_nor_centres_compared_between_plants(perceptions):
    for one in paired_tests.paired(perceptions):
        if one.metric in ("settling_s", "completion", "collision", "restricted_settling_s"):
            assert one.p is None
            assert one.p_holm is None
        if one.factor == "plant" and one.metric in ("collision", "completion"):
            assert one.difference is None
            assert one.n == 0
        if one.metric == "collision" and one.a.startswith("rigid"):
            assert one.n == 0


def test_p_values_are_adjusted_within_a_factor(dataset):
    changed = dataset.copy(deep=True)
    changed["collision_footprint"] = (("case", "trial"), np.array([[1.0, 1.0, 1.0], [0.0, 0.0, 0.0]]))
    changed.attrs |= dataset.attrs
    family = [one for one in paired_tests.paired(changed) if one.p is not None]
    assert [one.p_holm for one in family] == intervals.holm([one.p for one in family])
    hulls = next(one for one in family if one.metric == "collision_footprint")
    assert hulls.p == pytest.approx(0.25)  # 2 / 2^3
    assert hulls.p_holm > hulls.p


def test_an_interaction_is_a_difference_of_the_bodys_effects(perceptions):
    changed = perceptions.copy(deep=True)
    for label, values in {
        "particle/gauss-markov/gps": [0.5, 0.7],
        "rigid/gauss-markov/gps": [0.2, 0.3],
        "particle/filter/gps": [0.4, 0.4],
        "rigid/filter/gps": [0.4, 0.3],
    }.items():
        changed.in_band.loc[{"case": label}] = values
    found = next(
        one
        for one in paired_tests.interactions(changed)
        if (one.estimator, one.metric, one.a, one.b) == ("gps", "in_band_fraction", "gauss-markov", "filter")
    )
    # (0.3, 0.4) less (0.0, 0.1).
    assert found.difference == pytest.approx(0.3)
    assert found.n == 2


def test_equivalence_needs_the_whole_interval_within_the_margin(perceptions):
    changed = many(perceptions, 6)
    changed.arrival.loc[{"case": "particle/filter/gps"}] = [10.0, 10.4] * 6
    changed.arrival.loc[{"case": "particle/fitted/gps"}] = [10.2, 10.1] * 6
    changed.arrival.loc[{"case": "rigid/filter/gps"}] = [10.0, 13.0] * 6
    changed.arrival.loc[{"case": "rigid/fitted/gps"}] = [10.2, 10.1] * 6
    found = {
        one.plant: one
        for one in paired_tests.equivalences(changed)
        if (one.estimator, one.metric) == ("gps", "arrival_s")
    }
    assert found["particle"].equivalent is True
    assert found["rigid"].equivalent is False
    assert found["rigid"].margin == 1.0
    # Nobody arrives or forms within two seconds, which is no proof of anything; nor are two trials.
    for study_, metrics_ in ((many(perceptions, 6), ("arrival_s", "time_to_formation_s")), (perceptions, MEASURED)):
        judged = [one for one in paired_tests.equivalences(study_) if one.metric in metrics_]
        assert judged
        assert all(one.equivalent is None for one in judged)


def test_the_median_of_differences_of_which_some_are_beyond_the_horizon_is_open(perceptions):
    changed = many(perceptions, 6)
    changed.attrs["duration"] = 80.0
    changed["contact"] = changed.contact * np.nan
    changed["overturned"] = changed.overturned * np.nan
    changed.formation.loc[{"case": "particle/filter/gps"}] = [30.0] * 9 + [np.nan] * 3
    changed.formation.loc[{"case": "rigid/filter/gps"}] = [32.0] * 7 + [np.nan] * 5
    found = next(
        one
        for one in paired_tests.paired(changed)
        if (one.a, one.b, one.metric) == ("particle/filter/gps", "rigid/filter/gps", "time_to_formation_s")
    )
    # Seven differences of -2 s, two of at most -50 s, three of which nothing is known: the third smallest may be
    # anything, the third largest too, but the middle ones are -2.
    assert found.median.median == -2.0
    assert found.median.low is None
    assert found.median.high is None
    assert found.difference == pytest.approx((7 * -2.0 + 2 * -50.0) / 12)
