from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from dynabot_mj.common import intervals
from dynabot_mj.experiments.formation import power, power_laws, power_request

A, B = "particle/gauss-markov/gps", "rigid/gauss-markov/gps"
HULLS = power_request.Request(a=A, b=B, measure="collision_footprint")
ARRIVAL = power_request.Request(a=A, b=B, measure="arrival_s", difference=1.0)


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
    assert (saved.a, saved.b, saved.n) == (A, B, 40)
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
