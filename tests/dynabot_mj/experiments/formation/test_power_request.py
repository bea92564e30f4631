from dataclasses import replace

import numpy as np
import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.experiments.formation import power, power_request

A, B = "particle/gauss-markov/gps", "rigid/gauss-markov/gps"
HULLS = power_request.Request(a=A, b=B, measure="collision_footprint")
ARRIVAL = power_request.Request(a=A, b=B, measure="arrival_s", difference=1.0)


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
