from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from dynabot_mj.common import intervals
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.experiments.formation import power, power_laws

A, B = "particle/gauss-markov/gps", "rigid/gauss-markov/gps"
TRIALS = 40
HULLS = power.Request(a=A, b=B, measure="collision_footprint")
ARRIVAL = power.Request(a=A, b=B, measure="arrival_s", difference=1.0)


@pytest.fixture
def pilot(dataset):
    """A study of 40 trials, in which 16 pairs are discordant, 12 of them one way, and B arrives a second after A."""
    study = xr.concat([dataset] * 14, "trial", data_vars="minimal").isel(trial=slice(TRIALS))
    study = study.assign_coords(trial=np.arange(TRIALS))
    first, second = np.repeat([1.0, 0.0], [12, 28]), np.repeat([0.0, 1.0, 0.0], [12, 4, 24])
    study["collision_footprint"] = (("case", "trial"), np.array([first, second]))
    common, own = np.random.default_rng(0).normal(size=(2, 2, TRIALS))
    study["arrival"] = (("case", "trial"), np.array([10.0 + common[0], 11.0 + common[0] + 0.5 * own[0]]))
    study.attrs = dataset.attrs
    return study


def test_a_rate_needs_what_the_exact_test_needs_with_the_pilots_discordant_pairs(pilot):
    plan = power.planned(pilot, replace(HULLS, difference=25.0))
    (need,) = plan.needs
    assert (need.origin, need.difference, need.discordant, need.raised) == ("given", 0.25, 0.4, False)
    assert need.trials == need.pairs == power_laws.mcnemar_pairs(0.325, 0.075, 0.05, 0.8)
    assert need.power.rate == power_laws.mcnemar(need.pairs, 0.325, 0.075, 0.05)
    assert (plan.discordant.k, plan.discordant.n) == (16, 40)
    curve = {one.trials: one for one in plan.curve}
    assert curve[need.trials].power == need.power.rate
    assert min(curve) < need.trials < max(curve)


def test_discordant_pairs_are_no_fewer_than_the_difference(pilot):
    (need,) = power.planned(pilot, replace(HULLS, difference=-50.0)).needs
    assert (need.discordant, need.raised) == (0.5, True)
    assert need.pairs == power_laws.mcnemar_pairs(0.5, 0.0, 0.05, 0.8)


def test_the_pilots_own_difference_is_told_with_the_ends_of_its_interval(pilot):
    plan = power.planned(pilot, HULLS)
    told = intervals.paired_rates(*pilot.collision_footprint.values)
    assert [(one.origin, one.difference) for one in plan.needs] == [
        ("pilot", told.difference),
        ("low", 0.0),  # it includes 0
        ("high", told.high),
    ]
    own, low, high = plan.needs
    assert high.trials < own.trials
    assert (low.trials, low.power) == (None, None)
    assert told.low < 0.0


def test_a_time_needs_what_sign_flips_of_the_pilots_shifted_differences_need(pilot):
    plan = power.planned(pilot, replace(ARRIVAL, difference=0.4))
    (need,) = plan.needs
    a, b = pilot.arrival.values
    shifted = a - b - (a - b).mean() + 0.4
    assert need.pairs == power_laws.sign_flip_pairs(shifted, 0.05, 0.8, int(pilot.attrs["seed"]))
    assert need.power.low >= 0.8
    assert need.discordant is None
    assert plan.discordant is None
    assert all(one.low <= one.power <= one.high for one in plan.curve)


@pytest.mark.parametrize("request_", [replace(HULLS, difference=25.0), replace(ARRIVAL, difference=0.4)])
def test_cases_the_other_way_round_need_as_many(pilot, request_):
    turned = replace(request_, a=B, b=A, difference=-request_.difference)
    assert power.planned(pilot, turned).needs[0].pairs == power.planned(pilot, request_).needs[0].pairs


def test_each_of_several_comparisons_is_held_to_its_part_of_alpha(pilot):
    plan = power.planned(pilot, replace(HULLS, difference=25.0, comparisons=5))
    assert plan.alpha == pytest.approx(0.01)
    assert plan.needs == power.planned(pilot, replace(HULLS, difference=25.0, alpha=0.01)).needs


def test_trials_without_a_value_are_made_up_for(pilot):
    pilot.arrival[1, :20] = np.nan
    (need,) = power.planned(pilot, replace(ARRIVAL, difference=0.4)).needs
    assert need.trials == 2 * need.pairs


def test_what_common_random_numbers_save_is_a_ratio_of_variances(pilot):
    plan = power.planned(pilot, replace(ARRIVAL, difference=0.4))
    a, b = pilot.arrival.values
    (saved,) = plan.variances
    assert (saved.a, saved.b, saved.n) == (A, B, TRIALS)
    assert saved.ratio == pytest.approx((a.var(ddof=1) + b.var(ddof=1)) / (a - b).var(ddof=1))
    assert saved.ratio > 3.0
    assert plan.unpaired_trials == int(np.ceil(saved.ratio * plan.needs[0].trials))


def test_all_pairs_of_cases_are_told_what_is_saved(pilot):
    other = pilot.isel(case=[0]).assign_coords(case=["particle/gauss-markov/coupled"], estimator=("case", ["coupled"]))
    study = xr.concat([pilot, other], "case", data_vars="minimal")
    study.attrs = pilot.attrs
    plan = power.planned(study, replace(ARRIVAL, difference=0.4))
    assert [(one.a, one.b) for one in plan.variances] == [(A, B), (A, "particle/gauss-markov/coupled")]
    assert plan.variances[1].ratio is None  # the same trials twice


def test_a_difference_that_is_too_small_needs_more_than_is_told(pilot):
    plan = power.planned(pilot, replace(HULLS, difference=0.01))
    assert (plan.needs[0].trials, plan.unpaired_trials) == (None, None)
    assert max(one.power for one in plan.curve) < 0.8


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        (replace(HULLS, measure="hulls"), "--measure hulls given, it must be one of arrival_s, "),
        (replace(HULLS, a="particle/gauss-markov/gsp"), "the pilot has: .*; did you mean particle/gauss-markov/gps?"),
        (replace(HULLS, b=A), "given twice, it must be two cases"),
        (replace(HULLS, measure="completion"), "which is not compared between cases of another plant"),
        (replace(HULLS, alpha=0.0), "--alpha 0 given, allowed is 0 < alpha < 1"),
        (replace(HULLS, alpha=float("nan")), "--alpha nan given"),
        (replace(HULLS, comparisons=0), "--comparisons 0 given, it must be at least 1"),
        (replace(HULLS, power=1.0), "--power 1 given, it must be above alpha, 0.05, and at most 0.99$"),
        (replace(HULLS, power=0.05), "--power 0.05 given, it must be above alpha"),
        (replace(HULLS, power=80.0), "a fraction is meant: 0.8?"),
        (replace(HULLS, power=float("nan")), "--power nan given"),
        (replace(HULLS, difference=0.0), "--difference 0 given, it must be a number of points other than 0"),
        (replace(HULLS, difference=float("inf")), "--difference inf given, it must be a number"),
        (replace(HULLS, difference=-101.0), "--difference -101 given, allowed are -100 to 100 points"),
        (replace(ARRIVAL, difference=15.0), "--difference 15 given, allowed are -14 to 14 s, the duration"),
        (replace(ARRIVAL, comparisons=300), "the permutation test tells no smaller p"),
    ],
)
def test_what_cannot_be_answered_is_told(pilot, request_, message):
    with pytest.raises(InputError, match=message):
        power.planned(pilot, request_)


def test_pilots_that_say_too_little_are_told(pilot, dataset):
    with pytest.raises(
        InputError, match="the pilot has 3 trials with collision_footprint in both cases, it must be at"
    ):
        power.planned(dataset, HULLS)
    pilot.arrival[0] = np.nan
    with pytest.raises(InputError, match="--measure arrival_s given, which no trial of particle/gauss-markov/gps has"):
        power.planned(pilot, ARRIVAL)
    pilot.arrival[0] = pilot.arrival[1] - 1.0
    with pytest.raises(InputError, match="arrival_s differs by the same in all trials of the pilot"):
        power.planned(pilot, ARRIVAL)
    pilot.collision_footprint[0] = pilot.collision_footprint[1]
    with pytest.raises(InputError, match=r"the pilot's own difference is 0, for which no number .*; give --difference"):
        power.planned(pilot, HULLS)
    # With a difference it is all that is known of the discordant pairs.
    assert power.planned(pilot, replace(HULLS, difference=20.0)).needs[0].raised
