import json
from dataclasses import replace

import pytest

from dynabot_mj.common import intervals
from dynabot_mj.experiments.formation import power_report
from dynabot_mj.experiments.formation.measures import PAIRED
from dynabot_mj.experiments.formation.power import Need, Plan, Point, Request, Variances

MEASURES = {one.name: one for one in PAIRED}


@pytest.fixture
def plan():
    rate = intervals.Rate(rate=0.8, low=None, high=None, k=0, n=0)
    own = Need(origin="pilot", difference=0.25, discordant=0.4, raised=False, pairs=50, trials=50, power=rate)
    low = replace(own, origin="low", difference=0.0, pairs=None, trials=None, power=None)
    return Plan(
        request=Request(a="a", b="b", measure="collision_footprint"),
        measure=MEASURES["collision_footprint"],
        pilot_trials=40,
        estimate=intervals.Difference(difference=0.25, low=-0.1, high=0.45, n=40, p=0.05),
        discordant=intervals.share(16, 40),
        alpha=0.05,
        needs=[own, low, replace(own, origin="high", difference=0.45, discordant=0.45, raised=True, trials=20)],
        unpaired_trials=75,
        curve=[Point(trials=50, power=0.8, low=None, high=None)],
        variances=[Variances(a="a", b="b", n=40, variance_a=0.2, variance_b=0.1, variance_difference=0.2, ratio=1.5)],
    )


def test_the_table_has_what_is_needed_and_says_how_noisy_it_is(plan):
    text = power_report.markdown(plan)
    lines = text.splitlines()
    assert lines[0] == "# Trials for collision_footprint, a - b"
    assert [cell.strip() for cell in lines[4].strip("|").split("|")] == [
        "the pilot's own",
        "+25.0",
        "40.0",
        "50",
        "0.800",
    ]
    assert [cell.strip() for cell in lines[5].strip("|").split("|")] == [
        "0, in its interval", "+0.0", "40.0", "none is enough", "-",
    ]  # fmt: skip
    told = " ".join(text.split())
    assert "a noisy estimate" in told
    assert "The interval includes 0" in told
    assert "Discordant pairs are 40 [26, 55] % of the pilot's, fewer than a difference of +45.0 has" in told
    assert "about 75 of each case would be needed instead of 50" in told
    assert "2000" in lines[-4]  # variances in points
    assert max(map(len, lines)) <= 120


def test_what_is_given_is_not_called_noisy_and_comparisons_are_told(plan):
    given = replace(plan.needs[0], origin="given", trials=None)
    asked = replace(plan.request, comparisons=5)
    told = " ".join(power_report.markdown(replace(plan, needs=[given], request=asked, unpaired_trials=None)).split())
    assert "noisy" not in told
    assert "p below 0.05 / 5 (Holm's first step)" in told
    assert "more than 100000" in told
    assert "instead of" not in told


def test_times_are_told_with_the_interval_of_their_simulation(plan):
    share = intervals.share(8100, 10_000)
    need = replace(plan.needs[0], origin="given", difference=1.5, discordant=None, power=share)
    found = replace(plan, needs=[need], measure=MEASURES["arrival_s"], discordant=None, pilot_trials=44)
    text = power_report.markdown(found)
    assert "a - b [s]" in text
    assert "0.810 [0.802, 0.818]" in text
    assert "10000 studies" in text
    assert "40 pairs of this measure in 44 trials" in " ".join(text.split())
    assert "iscordant" not in text


def test_the_document_is_json(plan):
    told = json.loads(json.dumps(power_report.document(plan), allow_nan=False))
    assert (told["measure"], told["unit"], told["test"]) == ("collision_footprint", "points", "mcnemar")
    assert told["needs"][0]["trials"] == 50
    assert told["pilot"]["discordant"]["k"] == 16
    assert told["variances"][0]["ratio"] == 1.5
